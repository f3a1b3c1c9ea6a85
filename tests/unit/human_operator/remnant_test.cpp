// SPDX-License-Identifier: Apache-2.0
#include "services/core/human_operator/remnant.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stillhand::human_operator::remnant_test {

constexpr int kSeconds = 4000;

/// Variance of the noise integrated over one second [m^2 s^2]: Phi * 1 s for white noise.
double integrated_variance(double ratio, double floor_m, double error_rms_m) {
  Remnant sut(ratio, floor_m, 11, 0);
  for (int n = 0; n < 40'000; ++n) sut.step(error_rms_m);  // ten times its memory
  double sum = 0.0;
  for (int second = 0; second < kSeconds; ++second) {
    double integral = 0.0;
    for (int n = 0; n < 1000; ++n) integral += sut.step(error_rms_m) * kControlPeriod_s;
    sum += integral * integral;
  }
  return sum / kSeconds;
}

// Eq. HO-4.  4000 independent normal values: the variance has a relative deviation of sqrt(2/4000)
// = 2.2 %; five of them are 11 %.
TEST(RemnantTest, ItsDensityIsTheRatioTimesTheErrorsPower) {
  const double expected = std::numbers::pi * 0.01 * 0.02 * 0.02;
  EXPECT_NEAR(integrated_variance(0.01, 0.0, 0.02), expected, 0.11 * expected);
}

TEST(RemnantTest, ItScalesWithTheErrorExactly) {
  // Same seed, so the same draws: four times the variance to rounding.
  const double single = integrated_variance(0.01, 0.0, 0.01);
  EXPECT_NEAR(integrated_variance(0.01, 0.0, 0.02), 4.0 * single, 1e-9 * single);
}

TEST(RemnantTest, TheFloorStaysWhenTheErrorIsGone) {
  const double expected = std::numbers::pi * 0.01 * 0.001 * 0.001;
  EXPECT_NEAR(integrated_variance(0.01, 0.001, 0.0), expected, 0.11 * expected);
}

TEST(RemnantTest, RatioZeroSwitchesItOff) {
  Remnant sut(0.0, 0.001, 1, 0);
  for (int n = 0; n < 1000; ++n) ASSERT_EQ(sut.step(0.1), 0.0);
}

TEST(RemnantTest, SeedAndStreamFixItsBits) {
  Remnant sut(0.01, 0.001, 1, 0), same(0.01, 0.001, 1, 0), seed(0.01, 0.001, 2, 0),
      stream(0.01, 0.001, 1, 1);
  int equal_to_seed = 0;
  int equal_to_stream = 0;
  for (int n = 0; n < 1000; ++n) {
    const double v_m = sut.step(0.01);
    ASSERT_EQ(v_m, same.step(0.01));
    equal_to_seed += v_m == seed.step(0.01) ? 1 : 0;
    equal_to_stream += v_m == stream.step(0.01) ? 1 : 0;
  }
  EXPECT_EQ(equal_to_seed, 0);
  EXPECT_EQ(equal_to_stream, 0);
}

// Eq. HO-7: the growth multiplies the density, so its root multiplies every draw.
TEST(RemnantTest, GrowthMultipliesItsPower) {
  Remnant sut(0.02, 0.001, 4, 2);
  Remnant grown(0.02, 0.001, 4, 2);
  for (int n = 0; n < 1000; ++n) {
    ASSERT_NEAR(grown.step(0.03, 4.0), 2.0 * sut.step(0.03), 1e-15) << n;
  }
}

}  // namespace stillhand::human_operator::remnant_test
