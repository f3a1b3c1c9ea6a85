// SPDX-License-Identifier: Apache-2.0
// Eq. DR-17.
#include "services/core/device_rig/same_side.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace stillhand::device_rig::same_side_test {

/// Commanded acceleration of 0.9 and 2.3 Hz [m/s^2].
double commanded(double tick) {
  const double turn = 2.0 * std::numbers::pi * 1e-3 * tick;
  return std::sin(0.9 * turn) + 0.7 * std::sin(2.3 * turn);
}

SameSide after(int ticks, double gain, double lag_ticks = 0.0, double amplitude = 1.0) {
  SameSide sut;
  for (int tick = 0; tick < ticks; ++tick) {
    sut.step(1.65 + gain * amplitude * commanded(tick - lag_ticks), amplitude * commanded(tick));
  }
  return sut;
}

TEST(SameSideTest, ASensorThatIsTurnedRoundIsOpposed) {
  EXPECT_FALSE(after(2999, -0.1).opposed());
  EXPECT_TRUE(after(3000, -0.1).opposed());
  EXPECT_TRUE(after(10'000, -0.001).opposed()) << "the gain does not matter";
}

// A platform of 6 Hz is some 30 ms behind its set-point.
TEST(SameSideTest, ALaggingPlatformIsNotOpposedByItsLagAlone) {
  for (const double lag : {0.0, 30.0, 60.0}) EXPECT_FALSE(after(10'000, 0.1, lag).opposed());
  // Of whole cycles the correlation is -(cos(0.9 w) + 0.49 cos(2.3 w))/1.49, w = 2 pi lag: -0.40
  // and -0.26, on both sides of -0.3.
  EXPECT_TRUE(after(10'000, -0.1, 130.0).opposed());
  EXPECT_FALSE(after(10'000, -0.1, 150.0).opposed());
}

TEST(SameSideTest, WithoutMotionItIsSilent) {
  EXPECT_FALSE(after(10'000, -0.1, 0.0, 0.1).opposed());  // 0.09 m/s^2 RMS
  EXPECT_TRUE(after(10'000, -0.1, 0.0, 0.3).opposed());   // 0.26
  SameSide sut;
  for (int tick = 0; tick < 5000; ++tick) sut.step(0.0, 0.0);
  EXPECT_FALSE(sut.opposed());
}

TEST(SameSideTest, WhatIsNoNumberDoesNotCount) {
  SameSide sut = after(3000, -0.1);
  sut.step(std::numeric_limits<double>::quiet_NaN(), 1.0);
  sut.step(1.0, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(sut.opposed());
  sut.reset();
  EXPECT_FALSE(sut.opposed());
}

}  // namespace stillhand::device_rig::same_side_test
