// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/noise_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

TEST(NoiseModelTest, ASampleOfSlowNoiseHoldsLessThanAnIndependentOne) {
  constexpr std::size_t kCount = 40000;
  const std::vector<double> e = white(kCount, 1);
  const Eigen::Map<const Eigen::VectorXd> independent(e.data(), kCount);
  EXPECT_EQ(correlation_samples(independent, 100.0), 1.0);
  // r(n) = 0.9 r(n-1) + e(n): 1 + 2 x 0.9/(1 - 0.9) = 19, without what is below 0.05: 18.
  Eigen::VectorXd slow = independent;
  for (Eigen::Index n = 1; n < slow.size(); ++n) slow[n] += 0.9 * slow[n - 1];
  EXPECT_NEAR(correlation_samples(slow, 100.0), 18.0, 2.0);
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
