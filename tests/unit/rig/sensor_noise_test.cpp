// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/parts/sensor_noise.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace stillhand::rig::sensor_noise_test {
namespace {

constexpr int kDraws = 2000000;

/// Probability that the magnitude of a normal deviate exceeds x.
double beyond(double x) { return std::erfc(x / std::numbers::sqrt2); }

// Shares of N magnitudes above x, at five standard errors sqrt(p (1 - p) / N).  The points lie in
// the core, where the wedges matter, and in the tail beyond 3.4426; ten million samples put 633
// beyond 4, where a tail that is merely exponential would put 850.
TEST(SensorNoiseTest, HasTheDistributionFunctionOfTheNormal) {
  constexpr int kMany = 10000000;
  const std::array<double, 8> points = {0.3, 1.0, 2.0, 3.0, 3.4426, 3.6, 4.0, 4.5};
  SensorNoise sut(11, 1);
  std::array<int, 8> above{};
  for (int n = 0; n < kMany; ++n) {
    const double x = std::abs(sut());
    for (std::size_t i = 0; i < points.size(); ++i) above[i] += x > points[i] ? 1 : 0;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double p = beyond(points[i]);
    EXPECT_NEAR(static_cast<double>(above[i]) / kMany, p, 5.0 * std::sqrt(p * (1.0 - p) / kMany))
        << points[i];
  }
}

// Standard errors of mean, variance, and lag-1 product of N white normal samples: 1, sqrt 2, 1 over
// sqrt N; of the fourth moment sqrt(96 / N).
TEST(SensorNoiseTest, IsWhiteWithUnitVariance) {
  SensorNoise sut(12, 1);
  double mean = 0.0;
  double variance = 0.0;
  double fourth = 0.0;
  double lagged = 0.0;
  double before = sut();
  for (int n = 0; n < kDraws; ++n) {
    const double x = sut();
    mean += x / kDraws;
    variance += x * x / kDraws;
    fourth += x * x * x * x / kDraws;
    lagged += x * before / kDraws;
    before = x;
  }
  const double root = std::sqrt(static_cast<double>(kDraws));
  EXPECT_NEAR(mean, 0.0, 5.0 / root);
  EXPECT_NEAR(variance, 1.0, 5.0 * std::numbers::sqrt2 / root);
  EXPECT_NEAR(fourth, 3.0, 5.0 * std::sqrt(96.0) / root);
  EXPECT_NEAR(lagged, 0.0, 5.0 / root);
}

TEST(SensorNoiseTest, StreamsOfOneSeedAreUnrelated) {
  SensorNoise one(1, 1);
  SensorNoise two(1, 2);
  double product = 0.0;
  constexpr int kPairs = 100000;
  for (int n = 0; n < kPairs; ++n) product += one() * two() / kPairs;
  EXPECT_NEAR(product, 0.0, 5.0 / std::sqrt(static_cast<double>(kPairs)));
}

}  // namespace
}  // namespace stillhand::rig::sensor_noise_test
