// SPDX-License-Identifier: Apache-2.0
#include "services/device_rig/core/set_point_guard.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace stillhand::device_rig {
namespace {

constexpr SetPointLimits kLimits{.workspace_m = 0.15,
                                 .max_velocity_m_s = 1.5,
                                 .max_acceleration_m_s2 = 15.0,
                                 .catch_velocity_m_s = 0.25,
                                 .stop_deceleration_m_s2 = 5.0};

SetPoint sine(int tick) {
  const double w_rad_s = 2.0 * std::numbers::pi;
  const double t_s = 1e-3 * tick;
  return {.follow = true,
          .position_m = 0.1 * std::sin(w_rad_s * t_s),
          .velocity_m_s = 0.1 * w_rad_s * std::cos(w_rad_s * t_s),
          .acceleration_m_s2 = -0.1 * w_rad_s * w_rad_s * std::sin(w_rad_s * t_s)};
}

// 0.1 m at 1 Hz asks for 0.63 m/s and 3.9 m/s^2: within the limits.  It begins at 0.63 m/s, which
// takes 42 ms to reach; 2 s later it is caught.
TEST(SetPointGuardTest, AMotionWithinTheLimitsPassesUnchanged) {
  SetPointGuard sut(kLimits);
  for (int tick = 0; tick < 4000; ++tick) {
    const auto out = sut.step(sine(tick));
    if (tick > 2000) {
      ASSERT_NEAR(out.set_point.position_m, sine(tick).position_m, 1e-12) << tick;
    }
  }
}

TEST(SetPointGuardTest, ItBeginsWhereThePlatformStands) {
  SetPointGuard sut(kLimits);
  sut.stand_at(0.08);
  const auto out = sut.step({.follow = true});
  // One tick at the largest acceleration.
  EXPECT_NEAR(out.set_point.position_m, 0.08, 15.0 * 1e-6 + 1e-12);
}

TEST(SetPointGuardTest, WithoutACommandItBrakesAndHolds) {
  SetPointGuard sut(kLimits);
  for (int tick = 0; tick < 2000; ++tick) sut.step(sine(tick));
  double last_m = 0.0;
  for (int tick = 0; tick < 200; ++tick) {
    const auto out = sut.step({});
    EXPECT_FALSE(out.set_point.follow);
    EXPECT_TRUE((out.flags & kInputStale) != 0);
    last_m = out.set_point.position_m;
  }
  // From 0.63 m/s at 5 m/s^2 in 126 ms.
  EXPECT_EQ(sut.step({}).set_point.velocity_m_s, 0.0);
  EXPECT_EQ(sut.step({}).set_point.position_m, last_m);
}

TEST(SetPointGuardTest, NoCommandWhateverLeavesTheLimits) {
  SetPointGuard sut(kLimits);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> far(-1.0, 1.0);
  const double kWild[]{std::nan(""), std::numeric_limits<double>::infinity(), 1e300, -1e300, 0.0};
  double last_m = 0.0;
  for (int tick = 0; tick < 20'000; ++tick) {
    SetPoint wanted{.follow = random() % 10 != 0,
                    .position_m = far(random),
                    .velocity_m_s = 10.0 * far(random),
                    .acceleration_m_s2 = 100.0 * far(random)};
    if (random() % 20 == 0) wanted.position_m = kWild[random() % 5];
    const auto out = sut.step(wanted);
    ASSERT_LE(std::abs(out.set_point.position_m), kLimits.workspace_m);
    ASSERT_LE(std::abs(out.set_point.velocity_m_s), kLimits.max_velocity_m_s);
    // A tick at the largest speed, with the rounding of a sum.
    ASSERT_LE(std::abs(out.set_point.position_m - last_m), 1.5e-3 + 1e-12);
    last_m = out.set_point.position_m;
  }
}

}  // namespace
}  // namespace stillhand::device_rig
