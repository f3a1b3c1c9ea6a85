// SPDX-License-Identifier: Apache-2.0
#include "services/core/human_operator/fast_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stillhand::human_operator::fast_error_test {

/// Mean of E over the last 20 s of 60 s of a sine of 10 mm.
double mean_square(double frequency_hz) {
  FastError sut(0.5, 4.0);
  double sum = 0.0;
  for (int n = 0; n < 60'000; ++n) {
    sut.step(0.010 * std::sin(2.0 * std::numbers::pi * frequency_hz * n * kControlPeriod_s));
    if (n >= 40'000) sum += sut.mean_square_m2();
  }
  return sum / 20'000.0;
}

// Oracle: A^2/2 / (1 + (f_c/f)^4), Butterworth.  After 40 s exp(-10) = 5e-5 of the run-in is left,
// averaged over 20 s 1e-5; the warping at 2 Hz is below 1e-4.
TEST(FastErrorTest, ItIsThePowerAboveTheCutoff) {
  for (const double f : {0.1, 0.25, 0.5, 1.0, 2.0}) {
    const double expected = 0.5e-4 / (1.0 + std::pow(0.5 / f, 4.0));
    EXPECT_NEAR(mean_square(f), expected, 2e-4 * expected + 1e-9) << f << " Hz";
  }
}

TEST(FastErrorTest, ResetForgetsEverything) {
  FastError sut(0.5, 4.0);
  for (int n = 0; n < 1000; ++n) sut.step(n % 2 == 0 ? 0.1 : -0.1);
  ASSERT_GT(sut.mean_square_m2(), 0.0);
  sut.reset();
  sut.step(0.0);
  EXPECT_EQ(sut.mean_square_m2(), 0.0);
}

}  // namespace stillhand::human_operator::fast_error_test
