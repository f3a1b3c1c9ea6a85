// SPDX-License-Identifier: Apache-2.0
// Elements with memory, Eq. SG-19 and SG-20.
#include "services/core/signal/hysteresis.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "services/core/signal/random.hpp"

namespace stillhand::signal::hysteresis_test {
namespace {

using testing::ElementsAre;

using Operator = double (*)(double, HysteresisMemory&);

std::vector<double> answers(Operator sut, const std::vector<double>& z) {
  HysteresisMemory memory;
  std::vector<double> out;
  for (const double each : z) out.push_back(sut(each, memory));
  return out;
}

std::vector<double> random_walk(std::size_t count, double step, std::uint64_t seed) {
  signal::Gaussian next(seed, 0);
  std::vector<double> z{0.0};
  while (z.size() < count) z.push_back(z.back() + step * next());
  return z;
}

std::vector<double> swings(std::size_t periods, std::size_t samples, double amplitude) {
  std::vector<double> z;
  for (std::size_t n = 0; n <= periods * samples; ++n) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(n % samples);
    z.push_back(amplitude * std::sin(turn / static_cast<double>(samples)));
  }
  return z;
}

// Dyadic numbers: exact.
TEST(StopOperatorTest, ItFollowsUpToItsLimitAndYields) {
  EXPECT_THAT(answers(stop_operator, {5.0, 5.5, 6.0, 9.0, 8.5, 7.5, 7.0, 6.0, 6.25}),
              ElementsAre(0.0, 0.5, 1.0, 1.0, 0.5, -0.5, -1.0, -1.0, -0.75));
}

// z - stop(z) is play: it stands still while the element is elastic.
TEST(StopOperatorTest, WhatItTakesOffIsPlay) {
  const auto z = random_walk(2000, 0.4, 1);
  const auto sut = answers(stop_operator, z);
  for (std::size_t n = 1; n < z.size(); ++n) {
    ASSERT_LE(std::abs(sut[n]), 1.0);
    if (std::abs(sut[n]) < 1.0) {
      // Walks stay below 64: an ulp of it, twice.
      ASSERT_NEAR(z[n] - sut[n], z[n - 1] - sut[n - 1], 2e-14) << n;
    } else {
      ASSERT_GE((z[n] - z[n - 1]) * sut[n], 0.0) << "it yields along the motion, sample " << n;
    }
  }
}

// Along one way w tends to the sign with e^-|dz|: from rest w = 1 - e^-z.
TEST(DahlOperatorTest, FromRestItRisesExponentially) {
  const std::vector<double> z{0.0, 0.25, 0.5, 1.5, 4.0};
  const auto sut = answers(dahl_operator, z);
  for (std::size_t n = 0; n < z.size(); ++n) EXPECT_NEAR(sut[n], 1.0 - std::exp(-z[n]), 1e-15);
}

TEST(DahlOperatorTest, ATurnStartsFromTheStateThatWas) {
  const auto sut = answers(dahl_operator, {0.0, 1.0, 0.25});
  const double before = 1.0 - std::exp(-1.0);
  EXPECT_NEAR(sut[2], -1.0 + (before + 1.0) * std::exp(-0.75), 1e-15);
}

TEST(DahlOperatorTest, ItStaysBelowItsLimit) {
  for (const double each : answers(dahl_operator, random_walk(3000, 0.7, 2))) {
    ASSERT_LT(std::abs(each), 1.0);
  }
}

// How fast z moves does not matter, only where it turns: nine steps between two samples change
// nothing.  Rounding of ten exponentials a sample, and what is left of it fades.
TEST(DahlOperatorTest, BothElementsDependOnThePathAlone) {
  const auto coarse = random_walk(400, 0.5, 3);
  std::vector<double> fine{coarse[0]};
  for (std::size_t n = 1; n < coarse.size(); ++n) {
    for (int k = 1; k < 10; ++k) {
      fine.push_back(coarse[n - 1] + (coarse[n] - coarse[n - 1]) * k / 10.0);
    }
    fine.push_back(coarse[n]);
  }
  for (const Operator sut : {Operator(stop_operator), Operator(dahl_operator)}) {
    const auto once = answers(sut, coarse);
    const auto tenfold = answers(sut, fine);
    for (std::size_t n = 0; n < once.size(); ++n) ASSERT_NEAR(tenfold[10 * n], once[n], 1e-12) << n;
  }
}

// Work over a closed cycle, sum phi dz: never given back.
TEST(DahlOperatorTest, ACycleCostsWork) {
  constexpr std::size_t kSamples = 400;
  const auto work = [](Operator sut, double amplitude) {
    const auto z = swings(6, kSamples, amplitude);
    const auto phi = answers(sut, z);
    double sum = 0.0;
    for (std::size_t n = z.size() - kSamples; n < z.size(); ++n) {
      sum += 0.5 * (phi[n] + phi[n - 1]) * (z[n] - z[n - 1]);
    }
    return sum;
  };
  // A plastic element that swings by +-3 has the loop 4 (3 - 1); a trapezoid misses its corners by
  // at most half a step, 0.03, squared.
  EXPECT_NEAR(work(stop_operator, 3.0), 8.0, 0.01);
  EXPECT_NEAR(work(stop_operator, 0.9), 0.0, 1e-12) << "elastic: nothing is lost";
  for (const double amplitude : {0.3, 1.0, 3.0}) EXPECT_GT(work(dahl_operator, amplitude), 0.0);
}

// dw/dz over steps of 1/64, both ways: the stop's 1 exactly, Dahl's (1 + w) (1 - e^-h)/h from -1.
TEST(HysteresisOperatorTest, ItIsNoSteeperThanStated) {
  for (const auto operation : {HysteresisOperator::kStop, HysteresisOperator::kDahl}) {
    HysteresisMemory memory;
    double steepest = 0.0;
    double before = 0.0;
    for (int i = 0; i <= 4096; ++i) {
      const double z = 8.0 * std::sin(2.0 * std::numbers::pi * i / 1024.0);
      const double from = memory.previous;
      const double w = step_of(operation)(z, memory);
      if (i > 0 && z != from) steepest = std::max(steepest, (w - before) / (z - from));
      before = w;
    }
    EXPECT_LE(steepest, steepest_slope(operation) * (1.0 + 1e-9));
    EXPECT_GT(steepest, 0.9 * steepest_slope(operation));
  }
}

}  // namespace
}  // namespace stillhand::signal::hysteresis_test
