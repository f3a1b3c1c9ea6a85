// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/butterworth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "services/core/contract/config_error.hpp"

namespace stillhand::signal::butterworth_test {
namespace {

struct Design {
  int order;
  double cutoff_hz;
  double rate_hz;
  Passband pass;
};

// Fourier transform of the impulse response.  With the cutoff at a fiftieth of the rate or more the
// slowest pole has a radius below exp(-2 pi / 50 * 0.19) = 0.976 (order 8: cos of the pole angle is
// 0.195), and 3000 samples leave 0.976^3000 = 2e-32.
double measured_gain(const Design& d, double frequency_hz) {
  Butterworth sut(d.order, d.cutoff_hz, d.rate_hz, d.pass);
  std::complex<double> sum = 0.0;
  for (int n = 0; n < 3000; ++n) {
    const double angle = 2.0 * std::numbers::pi * frequency_hz / d.rate_hz * n;
    sum += sut.step(n == 0 ? 1.0 : 0.0) * std::polar(1.0, -angle);
  }
  return std::abs(sum);
}

// Eq. SG-4: |H|^2 = 1 / (1 + (tan(pi f/rate) / tan(pi fc/rate))^(2 order)).
double analytic_gain(const Design& d, double frequency_hz) {
  const double ratio = std::tan(std::numbers::pi * frequency_hz / d.rate_hz) /
                       std::tan(std::numbers::pi * d.cutoff_hz / d.rate_hz);
  const double power = std::pow(ratio, 2.0 * d.order);
  return d.pass == Passband::kLow ? 1.0 / std::sqrt(1.0 + power)
                                  : 1.0 / std::sqrt(1.0 + 1.0 / power);
}

class ButterworthTest : public ::testing::TestWithParam<Design> {};

TEST_P(ButterworthTest, MagnitudeFollowsTheAnalyticFormula) {
  EXPECT_NEAR(measured_gain(GetParam(), GetParam().cutoff_hz), std::numbers::sqrt2 / 2.0, 1e-12);
  for (double share = 0.02; share < 0.99; share += 0.03) {
    const double f = share * GetParam().rate_hz / 2.0;
    // 3000 terms of at most 1 with rounding 1e-16 each, and the filter's own, which its poles
    // enlarge by less than 1/(1 - 0.976).
    EXPECT_NEAR(measured_gain(GetParam(), f), analytic_gain(GetParam(), f), 2e-12) << f;
  }
}

TEST_P(ButterworthTest, MiddleOfThePassBandHasGainOne) {
  const Design& d = GetParam();
  Butterworth sut(d.order, d.cutoff_hz, d.rate_hz, d.pass);
  double y = 0.0;
  for (int n = 0; n < 3000; ++n) y = sut.step(d.pass == Passband::kLow || n % 2 == 0 ? 1.0 : -1.0);
  EXPECT_NEAR(std::abs(y), 1.0, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(OrdersAndBands, ButterworthTest,
                         ::testing::Values(Design{1, 10.0, 100.0, Passband::kLow},
                                           Design{2, 40.0, 200.0, Passband::kLow},
                                           Design{5, 10.0, 100.0, Passband::kLow},
                                           Design{8, 40.0, 1000.0, Passband::kLow},
                                           Design{4, 20.0, 100.0, Passband::kHigh},
                                           Design{7, 30.0, 100.0, Passband::kHigh}));

TEST(ButterworthSetupTest, WhatNyquistForbidsIsRefused) {
  EXPECT_THROW(Butterworth(5, 50.0, 100.0), ConfigError);
  EXPECT_THROW(Butterworth(5, 0.0, 100.0), ConfigError);
  EXPECT_THROW(Butterworth(5, std::nan(""), 100.0), ConfigError);
  EXPECT_THROW(Butterworth(0, 10.0, 100.0), ConfigError);
  EXPECT_THROW(Butterworth(9, 10.0, 100.0), ConfigError);
  EXPECT_THROW(Butterworth(5, 10.0, -100.0), ConfigError);
}

TEST(ButterworthSetupTest, ResetForgetsThePast) {
  Butterworth sut(5, 10.0, 100.0);
  const double fresh = sut.step(1.0);
  for (int n = 0; n < 50; ++n) sut.step(-3.0);
  sut.reset();
  EXPECT_EQ(sut.step(1.0), fresh);
}

TEST(ButterworthSetupTest, AWholeRecordIsFilteredFromRest) {
  Butterworth step_by_step(3, 5.0, 100.0);
  const std::vector<double> x{1.0, -2.0, 0.5, 4.0};
  const auto y = filtered(Butterworth(3, 5.0, 100.0), x);
  ASSERT_EQ(y.size(), x.size());
  for (std::size_t n = 0; n < x.size(); ++n) EXPECT_EQ(y[n], step_by_step.step(x[n]));
}

}  // namespace
}  // namespace stillhand::signal::butterworth_test
