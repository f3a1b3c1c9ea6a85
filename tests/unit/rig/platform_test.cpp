// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/parts/platform.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>

#include "services/core/contract/units.hpp"

namespace stillhand::rig::platform_test {
namespace {

constexpr double kDt_s = kControlPeriod_s;

PlatformDemand sinusoid(double amplitude_m, double frequency_hz, int n) {
  const double w = kTwoPi * frequency_hz;
  const double phase_rad = w * n * kDt_s;
  return {true, amplitude_m * std::sin(phase_rad), amplitude_m * w * std::cos(phase_rad),
          -amplitude_m * w * w * std::sin(phase_rad)};
}

/// Position over commanded position at one frequency, amplitude 1 mm, steady state.
std::complex<double> response(const PlatformConfig& config, double frequency_hz) {
  Platform sut(config);
  std::complex<double> in = 0.0;
  std::complex<double> out = 0.0;
  for (int n = 0; n < 6000; ++n) {
    const auto demand = sinusoid(1e-3, frequency_hz, n);
    const auto state = sut.step(demand).state;
    if (n < 3000) continue;
    const auto turn = std::polar(1.0, -kTwoPi * frequency_hz * n * kDt_s);
    in += demand.position_m * turn;
    out += state.position_m * turn;
  }
  return out / in;
}

// Paper III-C: "The platform bandwidth was confirmed to exceed 6Hz".
TEST(PlatformTest, BandwidthExceedsSixHertz) {
  for (const double f : {1.0, 2.0, 4.0, 6.0, 7.0}) {
    EXPECT_GT(std::abs(response(PlatformConfig{}, f)), std::numbers::sqrt2 / 2.0) << f << " Hz";
    EXPECT_LT(std::abs(response(PlatformConfig{}, f)), std::numbers::sqrt2) << f << " Hz";
  }
}

// Eq. RG-1 in continuous time.  Sampling at 1 kHz acts as a delay of at most two ticks in the loop,
// which changes the closed loop by at most 2 w dt |T|.
TEST(PlatformTest, FollowsTheTransferFunctionOfItsPositionLoop) {
  const PlatformConfig config{.acceleration_feedforward = 0.5};
  const double w = kTwoPi * config.loop_frequency_hz;
  for (const double f : {1.0, 3.0, 6.0, 12.0}) {
    const std::complex<double> s(0.0, kTwoPi * f);
    const auto loop = 2.0 * config.loop_damping * w * s + w * w;
    const auto expected = (0.5 * s * s + loop) / (config.torque_lag_s * s * s * s + s * s + loop);
    EXPECT_LT(std::abs(response(config, f) - expected),
              2.0 * kTwoPi * f * kDt_s * std::abs(expected))
        << f << " Hz";
  }
}

TEST(PlatformTest, TheDriveFollowsWithItsLag) {
  const PlatformConfig config;
  Platform sut(config);
  const double wanted_m_s2 =
      2.0 * config.loop_damping * 2.0 * std::numbers::pi * config.loop_frequency_hz * 0.01;
  // A tick of 1 ms is half of the lag.
  EXPECT_NEAR(sut.step({true, 0.0, 0.01, 0.0}).state.acceleration_m_s2,
              (1.0 - std::exp(-0.5)) * wanted_m_s2, 1e-9);
}

TEST(PlatformTest, StaysInsideItsLimitsWhateverIsAskedOfIt) {
  const PlatformConfig config;
  Platform sut(config);
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  PlatformDemand demand{true, 0.0, 0.0, 0.0};
  Flags seen = kGood;
  for (int n = 0; n < 200000; ++n) {
    if (n % 97 == 0) {
      demand = {uniform(random) > -0.8, 3.0 * uniform(random), 20.0 * uniform(random),
                500.0 * uniform(random)};
    }
    const auto out = sut.step(demand);
    seen |= out.flags;
    ASSERT_LE(std::abs(out.state.position_m), config.workspace_m) << n;
    // 1e-9: rounding of v + ((top - v) / dt) dt.
    ASSERT_LE(std::abs(out.state.velocity_m_s), config.max_velocity_m_s + 1e-9) << n;
    ASSERT_LE(std::abs(out.state.acceleration_m_s2), config.max_acceleration_m_s2 + 1e-9) << n;
    // The guard brakes; it does not stop dead: what is left can brake in the room that is left,
    // to the rounding of 1e-9 m and one tick's motion at the lowest speed, A dt^2.
    const double room_m =
        config.workspace_m - std::copysign(1.0, out.state.velocity_m_s) * out.state.position_m;
    ASSERT_LE(std::pow(out.state.velocity_m_s, 2) / (2.0 * config.max_acceleration_m_s2),
              room_m + config.max_acceleration_m_s2 * kDt_s * kDt_s)
        << n;
    // Nor does it brake earlier than it must: RG-2 with both sides equal.
    if ((out.flags & kWorkspaceLimit) && out.state.position_m * out.state.velocity_m_s > 0.0) {
      const double stop_m = out.state.position_m + out.state.velocity_m_s *
                                                       std::abs(out.state.velocity_m_s) / 2.0 /
                                                       config.max_acceleration_m_s2;
      ASSERT_NEAR(std::abs(stop_m), config.workspace_m, 1e-9) << n;
    }
  }
  EXPECT_TRUE(seen & kWorkspaceLimit);
  EXPECT_TRUE(seen & kSaturated);
}

TEST(PlatformTest, ComesToRestInsideTheWorkspaceWhenTheCommandIsMissing) {
  const PlatformConfig config;
  Platform sut(config);
  for (int n = 0; n < 2070; ++n) sut.step(sinusoid(0.12, 0.8, n));
  auto out = sut.step({false, 0.0, 0.0, 0.0});
  EXPECT_TRUE(out.flags & kInputStale);
  const double speed_m_s = std::abs(out.state.velocity_m_s);
  ASSERT_GT(speed_m_s, 0.3);
  // Constant deceleration takes v/d; then the loop's exponential end, 20 time constants.
  const double rate_gain_s = 2.0 * config.loop_damping * kTwoPi * config.loop_frequency_hz;
  const double ticks =
      (speed_m_s / config.stop_deceleration_m_s2 + 20.0 / rate_gain_s + 10 * config.torque_lag_s) /
      kDt_s;
  for (int n = 0; n < static_cast<int>(ticks); ++n) {
    out = sut.step({false, 0.0, 0.0, 0.0});
    ASSERT_LE(std::abs(out.state.position_m), config.workspace_m);
  }
  EXPECT_LT(std::abs(out.state.velocity_m_s), 1e-6);
}

PlatformDemand held() { return {true, 0.1, 0.0, 0.0, true}; }

TEST(PlatformTest, HeldItBrakesAndComesSlowlyToTheNextCommand) {
  Platform sut{PlatformConfig{}};
  for (int n = 0; n < 2070; ++n) sut.step(sinusoid(0.12, 0.8, n));
  auto out = sut.step(held());
  for (int n = 0; n < 500; ++n) out = sut.step(held());
  EXPECT_EQ(out.flags, kInhibited);
  EXPECT_LT(std::abs(out.state.velocity_m_s), 1e-6);
  ASSERT_GT(std::abs(out.state.position_m), 0.03);
  double fastest_m_s = 0.0, hardest_m_s2 = 0.0;
  for (int n = 0; n < 3000; ++n) {
    out = sut.step({true, 0.0, 0.0, 0.0});
    fastest_m_s = std::max(fastest_m_s, std::abs(out.state.velocity_m_s));
    hardest_m_s2 = std::max(hardest_m_s2, std::abs(out.state.acceleration_m_s2));
  }
  // Eq. SG-21, 0.12 m/s and 0.37 m/s^2, and what the loop of damping 0.8 adds: less than a tenth.
  EXPECT_LT(fastest_m_s, 0.132);
  EXPECT_LT(hardest_m_s2, 0.41);
  EXPECT_NEAR(out.state.position_m, 0.0, 1e-9);
}

// In one process nobody is held: not a bit changes.
TEST(PlatformTest, AfterTheSlowWayACommandCountsAsItIs) {
  Platform held_before{PlatformConfig{}};
  Platform never_held{PlatformConfig{}};
  held_before.step(held());
  for (int n = 0; n < 3000; ++n) {
    const auto demand = n < 1500 ? PlatformDemand{true, 0.0, 0.0, 0.0} : sinusoid(0.05, 1.0, n);
    const auto a = held_before.step(demand).state;
    const auto b = never_held.step(demand).state;
    ASSERT_EQ(a.position_m, b.position_m) << n;
    ASSERT_EQ(a.acceleration_m_s2, b.acceleration_m_s2) << n;
  }
}

TEST(PlatformTest, TreatsACommandThatIsNotFiniteAsMissing) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Platform sut{PlatformConfig{}};
    const auto out = sut.step({true, 0.0, bad, 0.0});
    EXPECT_TRUE(out.flags & kInputInvalid);
    EXPECT_EQ(out.state.position_m, 0.0);
    EXPECT_EQ(out.state.acceleration_m_s2, 0.0);
  }
}

TEST(PlatformTest, ReachesADistantCommandNoFasterThanTheCatchVelocity) {
  const PlatformConfig config;
  Platform sut(config);
  double fastest_m_s = 0.0;
  Platform::Output out{};
  for (int n = 0; n < 3000; ++n) {
    out = sut.step({true, 0.1, 0.0, 0.0});
    fastest_m_s = std::max(fastest_m_s, out.state.velocity_m_s);
  }
  // The velocity loop behind the torque lag has z = 1 / (2 sqrt(2 z w tau)) = 1.02: no overshoot;
  // a tick of dead time costs at most 2 z w dt = 12 % of the last step towards it, itself below 10
  // %.
  EXPECT_LT(fastest_m_s, 1.012 * config.catch_velocity_m_s);
  EXPECT_NEAR(out.state.position_m, 0.1, 1e-6);
}

TEST(PlatformTest, RefusesALagThatMakesTheLoopUnstable) {
  const PlatformConfig config{.loop_frequency_hz = 30.0, .loop_damping = 0.3};
  EXPECT_THROW(Platform{config}, ConfigError);
}

}  // namespace
}  // namespace stillhand::rig::platform_test
