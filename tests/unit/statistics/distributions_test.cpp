// SPDX-License-Identifier: Apache-2.0
#include "services/core/statistics/distributions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace stillhand::statistics::distributions_test {
namespace {

// Closed forms, each within a few roundings.
constexpr double kRounding = 1e-14;
constexpr double kPi = std::numbers::pi;

TEST(DistributionsTest, TheNormalIsTheErrorFunction) {
  for (const double z : {-3.0, -0.5, 0.0, 1.96, 12.0}) {
    const double above = 0.5 * std::erfc(z / std::numbers::sqrt2);
    EXPECT_NEAR(normal_above(z) / above, 1.0, kRounding) << z;
    EXPECT_NEAR(normal_below(-z) / above, 1.0, kRounding) << z;
  }
}

// One degree of freedom is Cauchy's distribution.
TEST(DistributionsTest, StudentsTOfOneDegreeOfFreedomIsCauchys) {
  for (const double t : {-2.0, 0.0, 0.7, 30.0}) {
    EXPECT_NEAR(t_above(t, 1.0), 0.5 - std::atan(t) / kPi, kRounding) << t;
  }
  EXPECT_NEAR(t_quantile(0.9, 1.0), std::tan(0.4 * kPi), 1e-12);
  EXPECT_NEAR(t_upper_quantile(0.9, 1.0), -std::tan(0.4 * kPi), 1e-12);
}

// Two degrees of freedom: P(X > x) = exp(-x / 2).
TEST(DistributionsTest, ChiSquaredOfTwoDegreesOfFreedomIsExponential) {
  EXPECT_NEAR(chi_squared_above(3.0, 2.0), std::exp(-1.5), kRounding);
  EXPECT_NEAR(chi_squared_above(200.0, 2.0) / std::exp(-100.0), 1.0, 1e-12);
  EXPECT_NEAR(chi_squared_quantile(0.25, 2.0), -2.0 * std::log(0.75), kRounding);
}

// Two degrees of freedom above: P(F > f) = (1 + 2 f / d)^(-d / 2), d those below.
TEST(DistributionsTest, FishersFOfTwoDegreesAboveIsAPower) {
  EXPECT_NEAR(f_above(3.0, 2.0, 8.0), std::pow(1.75, -4.0), kRounding);
  EXPECT_NEAR(f_quantile(0.9, 2.0, 8.0), 4.0 * (std::pow(0.1, -0.25) - 1.0), 1e-12);
}

TEST(DistributionsTest, DegreesOfFreedomAndProbabilitiesAreChecked) {
  EXPECT_THROW(t_above(1.0, 0.0), std::domain_error);
  EXPECT_THROW(chi_squared_above(1.0, -1.0), std::domain_error);
  EXPECT_THROW(f_quantile(1.5, 2.0, 8.0), std::domain_error);
}

}  // namespace
}  // namespace stillhand::statistics::distributions_test
