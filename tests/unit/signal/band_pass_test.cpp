// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/band_pass.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stillhand::signal::band_pass_test {
namespace {

constexpr double kRateHz = 1000.0;

// Largest output once it has settled.
double gain_at(double frequency_hz) {
  BandPass sut(2, 0.5, 3.0, kRateHz);
  double most = 0.0;
  for (int n = 0; n < 40'000; ++n) {
    const double y = sut.step(std::sin(2.0 * std::numbers::pi * frequency_hz * n / kRateHz));
    if (n > 30'000) most = std::max(most, std::abs(y));
  }
  return most;
}

TEST(BandPassTest, BothEdgesAreAtMinusThreeDecibels) {
  // The other edge of order 2 adds 1/sqrt(1 + (0.5/3)^4): 0.04 %.
  EXPECT_NEAR(gain_at(0.5), std::sqrt(0.5), 1e-3);
  EXPECT_NEAR(gain_at(3.0), std::sqrt(0.5), 1e-3);
  EXPECT_GT(gain_at(1.2), 0.97);
  EXPECT_LT(gain_at(0.05), 0.011);
  EXPECT_LT(gain_at(30.0), 0.011);
}

TEST(BandPassTest, ResetForgets) {
  BandPass sut(2, 0.5, 3.0, kRateHz);
  const double first = sut.step(1.0);
  sut.step(5.0);
  sut.reset();
  EXPECT_EQ(sut.step(1.0), first);
}

}  // namespace
}  // namespace stillhand::signal::band_pass_test
