// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/second_order_lag.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/core/contract/tick.hpp"

namespace stillhand::signal::second_order_lag_test {
namespace {

constexpr double kW_rad_s = 13.0;
constexpr double kZ = 0.7;

// Oracle: the closed step response; the filter is exact, so rounding of 2000 steps is all.
TEST(SecondOrderLagTest, TheStepResponseIsThatOfTheOscillator) {
  SecondOrderLag sut(kW_rad_s, kZ, kControlPeriod_s);
  const double d = kW_rad_s * std::sqrt(1.0 - kZ * kZ);
  const double s = kZ * kW_rad_s;
  for (int n = 0; n < 2000; ++n) {
    const double t = n * kControlPeriod_s;
    const double decay = std::exp(-s * t);
    const auto state = sut.step(1.0);
    ASSERT_NEAR(state.x, 1.0 - decay * (std::cos(d * t) + s / d * std::sin(d * t)), 1e-12);
    ASSERT_NEAR(state.v, decay * kW_rad_s * kW_rad_s / d * std::sin(d * t), 1e-11);
  }
}

// Oracle: central difference of v while u is held.  Error <= dt^2/6 times the third derivative of
// v,
// <= 1e-6/6 w^4 = 5e-3, of an acceleration that starts at w^2 = 169.
TEST(SecondOrderLagTest, TheAccelerationIsTheSlopeOfTheVelocity) {
  SecondOrderLag sut(kW_rad_s, kZ, kControlPeriod_s);
  auto before = sut.step(1.0);
  auto now = sut.step(1.0);
  for (int n = 0; n < 1000; ++n) {
    const auto after = sut.step(1.0);
    ASSERT_NEAR(now.a, (after.v - before.v) * kControlRateHz / 2.0, 5e-3);
    before = now;
    now = after;
  }
}

// A ramp is followed with the lag 2 z / w; the step-wise input adds half a tick, the step's
// convention (u acts from now on) none.
TEST(SecondOrderLagTest, ARampIsFollowedWithTheLagThatTheDelayCounts) {
  SecondOrderLag sut(kW_rad_s, kZ, kControlPeriod_s);
  SecondOrderLag::State state{};
  double u = 0.0;
  for (int n = 0; n < 3000; ++n) {
    u = n * kControlPeriod_s;
    state = sut.step(u);
  }
  EXPECT_NEAR(u - state.x, 2.0 * kZ / kW_rad_s + kControlPeriod_s / 2.0, 1e-9);
}

TEST(SecondOrderLagTest, ResetPutsItToRest) {
  SecondOrderLag sut(kW_rad_s, kZ, kControlPeriod_s);
  for (int n = 0; n < 100; ++n) sut.step(1.0);
  sut.reset();
  const auto state = sut.step(0.0);
  EXPECT_EQ(state.x, 0.0);
  EXPECT_EQ(state.v, 0.0);
}

}  // namespace
}  // namespace stillhand::signal::second_order_lag_test
