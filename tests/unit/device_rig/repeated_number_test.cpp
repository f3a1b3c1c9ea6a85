// SPDX-License-Identifier: Apache-2.0
// Eq. DR-14.
#include "services/core/device_rig/repeated_number.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace stillhand::device_rig::repeated_number_test {

constexpr double kLeast = 0.5;  // [m/s^2]

// [m/s^2] at 1 Hz
double motion(int tick, double amplitude = 1.0) {
  return amplitude * std::sin(2.0 * std::numbers::pi * 1e-3 * tick);
}

TEST(RepeatedNumberTest, ANumberThatStandsWhileTheSeatMovesIsNoMeasurement) {
  RepeatedNumber sut(kLeast);
  for (int tick = 0; tick <= 200; ++tick) {
    EXPECT_FALSE(sut.repeats()) << tick;
    sut.step(0.25, motion(tick));
  }
  EXPECT_TRUE(sut.repeats());
  sut.step(0.2500001, motion(201));
  EXPECT_FALSE(sut.repeats());
}

TEST(RepeatedNumberTest, AStillSeatExcusesIt) {
  RepeatedNumber sut(kLeast);
  for (int tick = 0; tick < 5000; ++tick) sut.step(0.25, motion(tick, 0.2));
  EXPECT_FALSE(sut.repeats());
}

TEST(RepeatedNumberTest, TheLastBitThatFlickersIsEnough) {
  RepeatedNumber sut(kLeast);
  for (int tick = 0; tick < 5000; ++tick) {
    sut.step(tick % 150 == 0 ? 0.25 + 1.0 / 4096 : 0.25, motion(tick));
    EXPECT_FALSE(sut.repeats()) << tick;
  }
}

// It is silent or at its end, which DR-12 reports.
TEST(RepeatedNumberTest, AMissingNumberDoesNotRepeat) {
  RepeatedNumber sut(kLeast);
  for (int tick = 0; tick < 1000; ++tick) {
    sut.step(std::numeric_limits<double>::quiet_NaN(), motion(tick));
  }
  EXPECT_FALSE(sut.repeats());
}

}  // namespace stillhand::device_rig::repeated_number_test
