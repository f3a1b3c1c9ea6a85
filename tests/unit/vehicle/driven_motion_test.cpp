// SPDX-License-Identifier: Apache-2.0
#include "services/core/vehicle/driven_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "services/core/contract/units.hpp"
#include "services/core/signal/random.hpp"
#include "services/core/vehicle/vehicle_settings.hpp"

namespace stillhand::vehicle::driven_motion_test {
namespace {

Trial driven_trial() {
  Trial trial;
  trial.number = 1;
  trial.phase = TrialPhase::kTracking;
  trial.start_tick = 1000;
  trial.duration_ticks = 60'000;
  trial.ramp_ticks = 500;
  return trial;
}

motion::PlatformCommand shake(DrivenMotion& sut, Tick first, Tick ticks, double growth) {
  motion::PlatformCommand out;
  for (Tick n = first; n < first + ticks; ++n) {
    const double t = static_cast<double>(n - first) * kControlPeriod_s;
    out = sut.step(
        {n, std::min(0.002 * std::exp(growth * t), 0.5) * std::sin(kTwoPi * 2.0 * t), true});
  }
  return out;
}

// |x|, |v|, |a| and the stopping point (Eq. MO-1) of every command, for a stick that does anything.
TEST(DrivenMotionTest, NoStickMovesThePlatformBeyondItsLimits) {
  for (const std::string& name : preset_names()) {
    DrivenConfig config;
    config.vehicle = preset(name);
    config.vehicle.gain_m_s2_rad = 60.0;
    config.vehicle.max_acceleration_m_s2 = 9.0;
    config.oscillation.floor_rad = config.oscillation.ceiling_rad = 0.29;  // do not stop it early
    DrivenMotion sut(config);
    signal::Gaussian normal(2, 0);
    sut.arm({}, driven_trial(), true);
    double slow = 0.0;
    double moved = 0.0;
    for (Tick n = 0; n < 60'000; ++n) {
      if (n % 700 == 0) slow = 0.5 * normal();
      const auto at = sut.step({n, slow + 0.05 * normal(), n % 9 != 0});
      ASSERT_LE(std::abs(at.position_m), config.limits.max_position_m);
      ASSERT_LE(std::abs(at.velocity_m_s), config.limits.max_velocity_m_s);
      ASSERT_LE(std::abs(at.acceleration_m_s2), config.limits.max_acceleration_m_s2);
      const double stop = at.position_m + at.velocity_m_s * std::abs(at.velocity_m_s) /
                                              (2.0 * config.limits.max_acceleration_m_s2);
      ASSERT_LE(std::abs(stop), config.limits.max_position_m + 1e-14);  // rounding, as MO-1's test
      moved = std::max(moved, std::abs(at.position_m));
    }
    EXPECT_GT(moved, 0.02) << name;
  }
}

TEST(DrivenMotionTest, AGrowingOscillationBrakesThePlatformAndHoldsItUntilAnotherTrial) {
  DrivenConfig config;
  config.vehicle.gain_m_s2_rad = 50.0;
  DrivenMotion sut(config);
  sut.arm({}, driven_trial(), true);
  Tick n = 1000;
  motion::PlatformCommand at;
  for (; !sut.ended() && n < 20'000; ++n) {
    const double t = static_cast<double>(n - 1000) * kControlPeriod_s;
    at = sut.step({n, 0.002 * std::exp(1.5 * t) * std::sin(kTwoPi * 2.0 * t), true});
  }
  ASSERT_TRUE(sut.ended());
  EXPECT_TRUE(at.flags & kFault);
  EXPECT_GT(std::abs(at.velocity_m_s), 0.0);
  // Braking with at least stop_acceleration_m_s2, Eq. MO-4; one tick more to end at exactly 0.
  const auto needed = static_cast<Tick>(std::abs(at.velocity_m_s) /
                                        config.limits.stop_acceleration_m_s2 * kControlRateHz) +
                      2;
  for (Tick k = 0; k < needed; ++k) at = sut.step({n++, 0.3, true});
  EXPECT_EQ(at.velocity_m_s, 0.0);
  const double rest = at.position_m;
  for (Tick k = 0; k < 3000; ++k) at = sut.step({n++, 0.3, true});
  EXPECT_EQ(at.position_m, rest);
  EXPECT_TRUE(at.flags & kFault);
  sut.announce(Trial{});
  EXPECT_TRUE(sut.step({n++, 0.0, true}).flags & kFault);
  Trial next = driven_trial();
  next.start_tick = n + 1000;
  sut.arm({}, next, true);
  EXPECT_FALSE(sut.step({n++, 0.0, true}).flags & kFault);
}

// The length of a half wave counts every tick: of 6 Hz 83, and not the half of it, which would be
// out of the detector's band.
TEST(DrivenMotionTest, SamplesThatAreUnsoundDoNotHideAnOscillation) {
  DrivenMotion sut{DrivenConfig{}};
  sut.arm({}, driven_trial(), true);
  Tick n = 1000;
  for (; !sut.ended() && n < 20'000; ++n) {
    const double t = static_cast<double>(n - 1000) * kControlPeriod_s;
    const double theta_rad = 0.002 * std::exp(2.0 * t) * std::sin(kTwoPi * 6.0 * t);
    sut.step({n, std::clamp(theta_rad, -0.3, 0.3), n % 2 != 0});
  }
  EXPECT_TRUE(sut.ended());
  EXPECT_LT(n, 4000);
}

// A preset gives dynamics and delay; gain, bounds and detector stay those of the settings.
TEST(DrivenMotionTest, APresetReplacesTheDynamicsAlone) {
  VehicleSettings settings;
  settings.vehicle.gain_m_s2_rad = 7.0;
  settings.vehicle.max_acceleration_m_s2 = 2.0;
  settings.vehicle.lag_s = 9.0;
  settings.oscillation.floor_rad = 0.03;
  const DrivenConfig own = driven_config({}, settings, kOwnVehicle);
  EXPECT_EQ(own.vehicle.lag_s, 9.0);
  EXPECT_FALSE(own.vehicle.speed_follows);
  const DrivenConfig named = driven_config({}, settings, "wheelchair");
  EXPECT_EQ(named.vehicle.lag_s, preset("wheelchair").lag_s);
  EXPECT_EQ(named.vehicle.delay_s, preset("wheelchair").delay_s);
  EXPECT_TRUE(named.vehicle.speed_follows);
  for (const DrivenConfig& config : {own, named}) {
    EXPECT_EQ(config.vehicle.gain_m_s2_rad, 7.0);
    EXPECT_EQ(config.vehicle.max_acceleration_m_s2, 2.0);
    EXPECT_EQ(config.oscillation.floor_rad, 0.03);
  }
}

TEST(DrivenMotionTest, AStickOutsideOfATrialMovesNothing) {
  DrivenMotion sut{DrivenConfig{}};
  const auto at = shake(sut, 0, 3000, 2.0);
  EXPECT_EQ(at.position_m, 0.0);
  EXPECT_FALSE(sut.ended());
}

// In a trial that is not driven, the trajectory comes through bit for bit, as from the motion
// process, and the stick is not looked at.
TEST(DrivenMotionTest, ATrajectoryPassesBitForBit) {
  motion::MotionProfile profile;
  profile.kind = motion::MotionKind::kBandNoise;
  profile.duration_ticks = 5000;
  profile.ramp_ticks = 500;
  const motion::MotionTrajectory expected(profile, {});
  Trial trial = driven_trial();
  trial.phase = TrialPhase::kPegged;
  trial.duration_ticks = profile.duration_ticks;
  DrivenMotion sut{DrivenConfig{}};
  sut.arm(motion::MotionTrajectory(expected), trial, false);
  for (Tick n = 0; n < 6400; ++n) {
    const auto at = sut.step({n, 0.4 * std::sin(0.02 * static_cast<double>(n)), true});
    const auto wanted = expected.at(n + kLead_ticks - trial.start_tick + trial.ramp_ticks);
    ASSERT_EQ(at.position_m, wanted.position_m) << n;
    ASSERT_EQ(at.acceleration_m_s2, wanted.acceleration_m_s2) << n;
  }
}

}  // namespace
}  // namespace stillhand::vehicle::driven_motion_test
