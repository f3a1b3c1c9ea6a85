// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/noise_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "services/core/diagnosis/diagnose.hpp"
#include "tests/planted/recording.hpp"
#include "tests/planted/to_measurement.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::noise_model_test {

using made::white;
using testing::IsEmpty;

constexpr std::size_t kSamples = 20000;

Signals some_signals(std::size_t count = kSamples) {
  return {made::measurement_of({{"u", "m/s^2", white(count, 1)}, {"y", "N", white(count, 2)}}),
          {"u"},
          "y"};
}

/// r(n) = 0.4 r(n-1) - 0.3 r(n-2) + e(n)
Eigen::VectorXd coloured_noise(std::uint64_t seed) {
  const std::vector<double> e = white(kSamples, seed);
  Eigen::VectorXd r = Eigen::VectorXd::Zero(kSamples);
  for (Eigen::Index n = 2; n < r.size(); ++n) {
    r[n] = 0.4 * r[n - 1] - 0.3 * r[n - 2] + e[static_cast<std::size_t>(n)];
  }
  return r;
}

/// Correlation of neighbours.
double neighbours(const Eigen::VectorXd& r) {
  return r.head(r.size() - 1).dot(r.tail(r.size() - 1)) / r.squaredNorm();
}

TEST(NoiseModelTest, WhiteNoiseNeedsNoFilter) {
  const std::vector<double> e = white(kSamples, 3);
  EXPECT_THAT(whitening_taps(Eigen::Map<const Eigen::VectorXd>(e.data(), kSamples), some_signals()),
              IsEmpty());
}

TEST(NoiseModelTest, TheTapsAreThoseOfTheEquationThatMadeTheNoise) {
  const std::vector<double> sut = whitening_taps(coloured_noise(4), some_signals());
  ASSERT_GE(sut.size(), 3U);
  // Each has a standard error of 1/sqrt(20000) = 0.007; the share that counts as white, 0.01, moves
  // them by as much.
  EXPECT_NEAR(sut[1] / sut[0], -0.4, 0.03);
  EXPECT_NEAR(sut[2] / sut[0], 0.3, 0.03);
}

// Eq. DG-61: 24 numbers at most, and a hundred samples for each; the first tenth does not count.
TEST(NoiseModelTest, TheOrderIsBoundedByTheSamples) {
  const auto order_of = [](std::size_t count, std::size_t lag) {
    std::vector<double> r = white(count, 6);
    for (std::size_t n = lag; n < count; ++n) r[n] -= 0.8 * r[n - lag];
    return noise_taps(made::column_of(r), some_signals(count)).size() - 1;
  };
  EXPECT_EQ(order_of(190, 1), 1u);
  EXPECT_EQ(order_of(290, 2), 2u);
  EXPECT_EQ(order_of(kSamples, 24), 24u);
  EXPECT_LT(order_of(kSamples, 30), 24u) << "what is further back is not seen";
}

// One number: 1 - rho q^-1 over sqrt(1 - rho^2), rho the correlation of neighbours next to a white
// share of 1 %.
TEST(NoiseModelTest, TheFilterOfOneNumberIsTheCorrelationOfNeighbours) {
  std::vector<double> x = white(191, 6);
  for (std::size_t n = 1; n < x.size(); ++n) x[n] -= 0.8 * x[n - 1];
  const Eigen::VectorXd r = made::column_of(x);
  const double rho = neighbours(r) / 1.01;
  const std::vector<double> sut = noise_taps(r, some_signals(x.size()));
  ASSERT_EQ(sut.size(), 2u);
  EXPECT_NEAR(sut[0], 1.0 / std::sqrt(1.0 - rho * rho), 1e-12);
  EXPECT_NEAR(sut[1], -rho / std::sqrt(1.0 - rho * rho), 1e-12);
}

TEST(NoiseModelTest, WhatPassesTheFilterIsWhiteAndAsLarge) {
  const Signals signals = some_signals();
  Eigen::VectorXd sut = coloured_noise(5);
  const double before = sut.squaredNorm();
  const Signals whitened = signals.whitened(whitening_taps(sut, signals));
  // 0.4/(1 + 0.3)
  EXPECT_NEAR(neighbours(sut), 0.31, 0.03);
  whitened.whiten(sut, signals.weight());
  EXPECT_LT(std::abs(neighbours(sut)), 0.03);
  // Samples of weight 0 at the start are 0 behind it; the white share makes it a little smaller.
  EXPECT_NEAR(sut.squaredNorm() / before, 1.0, 0.05);
}

TEST(NoiseModelTest, NothingPassesFromOneStretchToTheNextOrFromASampleWithoutWeight) {
  Measurement measurement =
      made::measurement_of({{"u", "m/s^2", white(200, 1)}, {"y", "N", white(200, 2)}});
  measurement.stretches = {{0, 100, 0.0}, {100, 200, 2.0}};
  const Signals sut = Signals(measurement, {"u"}, "y").whitened({1.0, -1.0});
  std::vector<double> weight(200, 1.0);
  weight[50] = 0.0;
  Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(200, 1.0, 200.0);
  sut.whiten(x, weight);
  EXPECT_EQ(x[0], 1.0);
  EXPECT_EQ(x[1], 1.0);
  EXPECT_EQ(x[50], 0.0);
  EXPECT_EQ(x[100], 101.0);
  EXPECT_EQ(x[199], 1.0);
}

// rho_k = 1 - k/N of a constant of N samples, for 10 s or a quarter of them; 1 - k/30 of 30 among
// zeros, down to 0.067 at k = 28.  The sum to L: 1 + 2 L - L (L + 1)/N.
TEST(NoiseModelTest, CorrelationsCountForTenSecondsOrAQuarterOrAboveATwentieth) {
  const auto sum_to = [](double most, double count) {
    return 1.0 + 2.0 * most - most * (most + 1.0) / count;
  };
  Eigen::VectorXd short_one = Eigen::VectorXd::Zero(400);
  short_one.segment(50, 30).setOnes();
  EXPECT_NEAR(correlation_samples(Eigen::VectorXd::Ones(8000), 100.0), sum_to(1000, 8000), 1e-9);
  EXPECT_NEAR(correlation_samples(Eigen::VectorXd::Ones(2000), 100.0), sum_to(500, 2000), 1e-9);
  EXPECT_NEAR(correlation_samples(short_one, 100.0), sum_to(28, 30), 1e-9);
  EXPECT_EQ(correlation_samples(made::column_of(white(40000, 1)), 100.0), 1.0) << "independent";
}

// A friction of 15 % of the force under slow noise of 16 % of it, in a minute.
TEST(NoiseModelTest, AnEffectUnderSlowNoiseIsFoundBehindTheFilter) {
  planted::Spec spec;
  spec.kinds = {planted::Kind::kCoulombFriction};
  spec.strengths.assign(1, 0.15);
  spec.snr_db = 16.0;
  spec.noise = planted::NoiseShape::kLowPass;
  spec.length_s = 60.0;
  const Diagnosis sut = diagnose(planted::to_measurement(planted::draw(1, spec).recording), {});
  ASSERT_FALSE(sut.effects.empty());
  EXPECT_EQ(sut.effects[0].effect.kind, "coulomb_friction");
  EXPECT_TRUE(sut.search.whitened);
}

}  // namespace stillhand::diagnosis::noise_model_test
