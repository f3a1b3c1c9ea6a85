// SPDX-License-Identifier: Apache-2.0
#include "services/core/motion/platform_guard.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "services/core/contract/config_error.hpp"
#include "services/core/motion/motion_trajectory.hpp"
#include "services/core/signal/random.hpp"

namespace stillhand::motion::platform_guard_test {

constexpr double kDt_s = kControlPeriod_s;

GuardInput asking(double position_m, double velocity_m_s, double acceleration_m_s2) {
  return {true, {position_m, velocity_m_s, acceleration_m_s2, kGood}};
}

bool same_bits(const PlatformCommand& a, const PlatformCommand& b) {
  return a.position_m == b.position_m && a.velocity_m_s == b.velocity_m_s &&
         a.acceleration_m_s2 == b.acceleration_m_s2 && a.flags == b.flags;
}

// The promise of the guard for one step, Eqs. MO-1 and MO-2.  Position, velocity and acceleration
// bounds are exact comparisons.  The stopping point and the consistency of two samples are
// recomputed here, so they carry the rounding of a few operations on numbers up to X + V^2/2A:
// 1e-14 of 1 is 45 ulp.
std::string broken_promise(const PlatformCommand& from, const PlatformCommand& to,
                           const PlatformLimits& limits) {
  constexpr double kRounding = 1e-14;
  // At the wall the end velocity is found from the gap with a slope of up to 2/dt (Eq. MO-5): a few
  // ulp of 0.15 m (2.8e-17 each) times 2000/s is some 1e-13 m/s; 1e-12 m/s is 1e-9 m/s^2.
  constexpr double kRounding_m_s = 1e-12;
  const double a_max = limits.max_acceleration_m_s2;
  if (!(std::abs(to.position_m) <= limits.max_position_m)) return "position";
  if (!(std::abs(to.velocity_m_s) <= limits.max_velocity_m_s)) return "velocity";
  if (!(std::abs(to.acceleration_m_s2) <= a_max)) return "acceleration";
  const double stop_m = to.position_m + to.velocity_m_s * std::abs(to.velocity_m_s) / (2.0 * a_max);
  if (!(std::abs(stop_m) <= limits.max_position_m + kRounding)) return "stopping point";
  const double change_m_s = to.velocity_m_s - from.velocity_m_s;
  if (!(std::abs(change_m_s) <= a_max * kDt_s + kRounding_m_s)) return "change of velocity";
  const double deviation_m =
      to.position_m - from.position_m - 0.5 * (from.velocity_m_s + to.velocity_m_s) * kDt_s;
  const double slack_m = (a_max * a_max * kDt_s * kDt_s - change_m_s * change_m_s) / (4.0 * a_max);
  if (!(std::abs(deviation_m) <= std::max(slack_m, 0.0) + kRounding)) return "change of position";
  return {};
}

MotionTrajectory noise(std::uint64_t seed, double high_hz, double rms_m_s2, double peak_m_s2,
                       Tick duration_ticks = 20'000) {
  MotionProfile profile;
  profile.kind = MotionKind::kBandNoise;
  profile.seed = seed;
  profile.band_high_hz = high_hz;
  profile.rms_m_s2 = rms_m_s2;
  profile.peak_m_s2 = peak_m_s2;
  profile.duration_ticks = duration_ticks;
  return MotionTrajectory(profile, PlatformLimits{});
}

Tick length_of(const MotionTrajectory& t) { return t.duration_ticks() + 2 * t.ramp_ticks(); }

TEST(PlatformGuardTest, AFeasibleTrajectoryPassesBitForBit) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    for (const auto& trajectory : {noise(seed, 4.0, 2.0, 7.36), noise(seed, 2.0, 1.6, 7.5)}) {
      PlatformGuard sut{PlatformLimits{}};
      for (Tick i = 0; i <= length_of(trajectory); ++i) {
        const PlatformCommand asked = trajectory.at(i);
        ASSERT_TRUE(same_bits(sut.step({true, asked}), asked)) << "seed " << seed << " tick " << i;
      }
    }
  }
}

// One input of a hostile source: NaN, infinities, huge and tiny values, missing commands, jumps,
// sinusoids no platform can follow, pushes into a wall at full speed.
class HostileSource {
 public:
  HostileSource(std::uint64_t seed, const PlatformLimits& limits)
      : random_(seed, 0), limits_(limits) {}

  GuardInput next(const PlatformCommand& now) {
    if (left_-- <= 0) {
      mode_ = static_cast<int>(random_.uniform() * 8.0);
      left_ = static_cast<int>(std::exp(random_.uniform() * 7.0));
      side_ = random_.uniform() < 0.5 ? -1.0 : 1.0;
      w_rad_s_ = std::exp(random_.uniform() * 6.0);
    }
    const double x = limits_.max_position_m;
    const double v = limits_.max_velocity_m_s;
    const double a = limits_.max_acceleration_m_s2;
    time_s_ += kDt_s;
    switch (mode_) {
      case 0:
        return {};
      case 1:
        return asking(odd_value(), odd_value(), odd_value());
      case 2:
        return asking(spread(2.0 * x), spread(2.0 * v), spread(2.0 * a));
      case 3:
        return asking(side_ * x, side_ * v, side_ * a);
      case 4:
        return asking(2.0 * x * std::sin(w_rad_s_ * time_s_),
                      2.0 * x * w_rad_s_ * std::cos(w_rad_s_ * time_s_),
                      -2.0 * x * w_rad_s_ * w_rad_s_ * std::sin(w_rad_s_ * time_s_));
      case 5:  // consistent with the state and as hard as allowed: passed on until the wall
        return asking(now.position_m + (now.velocity_m_s + 0.5 * side_ * a * kDt_s) * kDt_s,
                      now.velocity_m_s + side_ * a * kDt_s, side_ * a);
      case 6:  // the same with the velocity kept: drifts to the wall
        return asking(now.position_m + now.velocity_m_s * kDt_s, now.velocity_m_s, 0.0);
      default:
        return asking(side_ * x * (1.0 + spread(1e-12)), spread(1e-9), spread(1e-9));
    }
  }

 private:
  double spread(double bound) { return bound * (2.0 * random_.uniform() - 1.0); }
  double odd_value() {
    const double values[] = {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::max(),
                             -std::numeric_limits<double>::max(),
                             std::numeric_limits<double>::denorm_min(),
                             -0.0,
                             0.15};
    return values[static_cast<std::size_t>(random_.uniform() * 8.0)];
  }

  signal::Gaussian random_;
  PlatformLimits limits_;
  int mode_ = 0;
  int left_ = 0;
  double side_ = 1.0;
  double w_rad_s_ = 1.0;
  double time_s_ = 0.0;
};

void expect_promise_kept(const PlatformLimits& limits, std::uint64_t seed, int steps,
                         double most_jerk_m_s3 = PlatformGuard::kAnyJerk_m_s3) {
  PlatformGuard sut(limits, most_jerk_m_s3);
  HostileSource source(seed, limits);
  double reached_m = 0.0;
  double fastest_m_s = 0.0;
  for (int n = 0; n < steps; ++n) {
    const PlatformCommand before = sut.state();
    const PlatformCommand after = sut.step(source.next(before));
    ASSERT_EQ(broken_promise(before, after, limits), "") << "seed " << seed << " step " << n;
    reached_m = std::max(reached_m, std::abs(after.position_m));
    fastest_m_s = std::max(fastest_m_s, std::abs(after.velocity_m_s));
  }
  // The source must have pushed: a guard that never moves would keep every bound.
  EXPECT_GT(reached_m, 0.99 * limits.max_position_m);
  const double sprint_m_s = std::min(
      limits.max_velocity_m_s, std::sqrt(limits.max_acceleration_m_s2 * limits.max_position_m));
  EXPECT_GT(fastest_m_s, 0.5 * sprint_m_s);
}

TEST(PlatformGuardTest, NoInputBreaksTheLimits) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    expect_promise_kept(PlatformLimits{}, seed, 200'000);
  }
  expect_promise_kept({0.02, 2.0, 15.0, 0.1, 100.0}, 11, 200'000);
  expect_promise_kept({0.15, 0.05, 0.5, 15.0, 5.0}, 12, 400'000);
  expect_promise_kept({0.001, 0.01, 1.0, 1.0, 20.0}, 13, 200'000);
}

// From any state the guard was driven to, the missing command brings rest.  Slowest stop: V over
// the stopping deceleration, 1.25/3 = 0.417 s; closer to a wall it is harder, hence shorter.  One
// tick more for the last, partial step, and one for the correction at the wall.
TEST(PlatformGuardTest, AMissingCommandBrakesToRestInTime) {
  const PlatformLimits limits;
  PlatformGuard driven(limits);
  HostileSource source(21, limits);
  const auto most_ticks = ticks_in(limits.max_velocity_m_s / limits.stop_acceleration_m_s2) + 2;
  for (int n = 0; n < 50'000; ++n) {
    driven.step(source.next(driven.state()));
    if (n % 97 != 0) continue;
    PlatformGuard sut = driven;
    for (Tick i = 0; i < most_ticks; ++i) {
      const PlatformCommand before = sut.state();
      const PlatformCommand after = sut.step({});
      ASSERT_EQ(broken_promise(before, after, limits), "");
      ASSERT_EQ(after.flags, kInputStale);
    }
    ASSERT_EQ(sut.state().velocity_m_s, 0.0) << "after step " << n;
    const double rest_m = sut.state().position_m;
    sut.step({});
    ASSERT_EQ(sut.state().position_m, rest_m);
    ASSERT_EQ(sut.state().acceleration_m_s2, 0.0);
  }
}

TEST(PlatformGuardTest, WithAJerkNoInputBreaksTheLimitsEither) {
  for (const double most_jerk_m_s3 : {100.0, 1000.0, 20'000.0}) {
    expect_promise_kept(PlatformLimits{}, 31, 100'000, most_jerk_m_s3);
  }
}

// Eq. MO-16, far from a wall: 0.5 m/s in the middle needs 0.5^2/(2 * 3) = 42 mm.
TEST(PlatformGuardTest, WithAJerkBrakingBeginsAndEndsSoftly) {
  constexpr double kJerk_m_s3 = 1000.0;
  for (const double before_m_s2 : {-2.0, 0.0, 2.0}) {
    PlatformGuard sut(PlatformLimits{}, kJerk_m_s3);
    // Up to 0.5 m/s within the limits, then on with the acceleration of before.
    PlatformCommand at;
    const auto go = [&](double acceleration_m_s2) {
      const double end_m_s = at.velocity_m_s + acceleration_m_s2 * kDt_s;
      at.position_m += 0.5 * (at.velocity_m_s + end_m_s) * kDt_s;
      at.velocity_m_s = end_m_s;
      at.acceleration_m_s2 = acceleration_m_s2;
      ASSERT_EQ(sut.step({true, at}).flags, kGood);
    };
    while (at.velocity_m_s < 0.4) go(std::min(at.acceleration_m_s2 + 0.9, 3.0));
    while (at.acceleration_m_s2 != before_m_s2) {
      go(at.acceleration_m_s2 + std::clamp(before_m_s2 - at.acceleration_m_s2, -0.9, 0.9));
    }
    double last_m_s2 = before_m_s2;
    int ticks = 0;
    for (; ticks < 400; ++ticks) {
      const PlatformCommand out = sut.step({});
      // The acceleration is a difference of speeds of 0.4 m/s, 5.6e-17 each, over a tick: 1e-13.
      ASSERT_LE(std::abs(out.acceleration_m_s2 - last_m_s2), kJerk_m_s3 * kDt_s + 1e-12) << ticks;
      ASSERT_LE(std::abs(out.acceleration_m_s2), 3.0 + 1e-12);
      last_m_s2 = out.acceleration_m_s2;
    }
    EXPECT_EQ(sut.state().velocity_m_s, 0.0);
    EXPECT_EQ(sut.state().acceleration_m_s2, 0.0);
  }
}

// A source that is lost where the wall is near: it takes more than the stopping deceleration,
// v^2/(2 gap) of Eq. MO-4, which stays the same until rest at the wall.
TEST(PlatformGuardTest, ACommandThatIsLostNearTheWallStopsBeforeIt) {
  PlatformLimits limits;
  limits.max_velocity_m_s = 1.5;
  limits.max_acceleration_m_s2 = 15.0;
  limits.stop_acceleration_m_s2 = 5.0;
  for (const double jerk_m_s3 : {PlatformGuard::kAnyJerk_m_s3, 1000.0}) {
    PlatformGuard sut(limits, jerk_m_s3);
    sut.stand_at(-0.1);
    EXPECT_EQ(sut.state().position_m, -0.1);
    // Away to the right as fast as it lets, until 1.2 m/s at some 0.07 m.
    while (sut.state().position_m < 0.071) sut.step(asking(0.15, 1.5, 0.0));
    const double speed_m_s = sut.state().velocity_m_s;
    ASSERT_GT(speed_m_s, 1.2);
    const double needed_m_s2 = speed_m_s * speed_m_s / 2.0 / (0.15 - sut.state().position_m);
    for (int n = 0; n < 400; ++n) {
      const PlatformCommand before = sut.state();
      ASSERT_EQ(broken_promise(before, sut.step({}), limits), "") << n;
      // At rest not before 2 0.079 m / 1.2 m/s = 131 ticks.
      ASSERT_TRUE(n > 99 || std::abs(sut.state().acceleration_m_s2 + needed_m_s2) < 1e-6) << n;
    }
    EXPECT_EQ(sut.state().velocity_m_s, 0.0);
  }
}

// Eq. MO-2 and MO-1 from rest, a percent to either side of their ends.  With 0.6 of
// the speed of a tick the way is (1 - 0.6^2)/4.  At the wall the way of the tick, 0.9/2, and to
// brake, 0.9^2/2.
TEST(PlatformGuardTest, WhatIsReachableEndsWhereItsEquationsSay) {
  constexpr double kFull_m_s = 9.0 * kDt_s;
  constexpr double kFull_m = kFull_m_s * kDt_s;
  for (const double share : {0.99, 1.01}) {
    const double cases[][3]{{0.0, share * 0.25 * kFull_m, 0.0},
                            {0.0, (0.3 + share * 0.64 * 0.25) * kFull_m, 0.6 * kFull_m_s},
                            {0.15 - 0.855 / share * kFull_m, 0.45 * kFull_m, 0.9 * kFull_m_s}};
    for (const auto& [from_m, by_m, v_m_s] : cases) {
      PlatformGuard sut{PlatformLimits{}};
      sut.stand_at(from_m);
      const Flags flags = sut.step(asking(from_m + by_m, v_m_s, 0.0)).flags;
      EXPECT_EQ(flags, share < 1.0 ? kGood : kWorkspaceLimit) << from_m << " " << v_m_s;
    }
  }
}

TEST(PlatformGuardTest, AnInvalidCommandIsTreatedAsMissingAndFlagged) {
  PlatformGuard sut{PlatformLimits{}};
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    EXPECT_EQ(sut.step(asking(bad, 0, 0)).flags, kInputInvalid);
    EXPECT_EQ(sut.step(asking(0, bad, 0)).flags, kInputInvalid);
    EXPECT_EQ(sut.step(asking(0, 0, bad)).flags, kInputInvalid);
  }
  EXPECT_EQ(sut.state().position_m, 0.0);
}

TEST(PlatformGuardTest, AStepIsShapedFlaggedAndReachedWithoutOvershoot) {
  PlatformGuard sut{PlatformLimits{}};
  double furthest_m = 0.0;
  EXPECT_EQ(sut.step(asking(0.1, 0, 0)).flags, kWorkspaceLimit);
  for (int n = 0; n < 3000; ++n) {
    const PlatformCommand at = sut.step(asking(0.1, 0, 0));
    furthest_m = std::max(furthest_m, at.position_m);
    // Half of 3 m/s^2 on the way, which the speed follows a time of 1/(4 w) late.
    if (at.position_m > 0.05 && at.position_m < 0.09) {
      const double left_m = 0.1 - at.position_m - 0.5 * 1.5 / 400.0;
      ASSERT_NEAR(at.velocity_m_s, std::sqrt(3.0 * left_m) + 1.5 / 80.0, 2e-3) << n;
    }
  }
  // The linear part of MO-3 is critically damped (below), so nothing overshoots; the guard locks
  // onto the command once it is within the slack of MO-2, A dt^2 / 4 = 2.25e-6 m.
  EXPECT_LE(furthest_m, 0.1 + 2.25e-6);
  EXPECT_TRUE(same_bits(sut.state(), {0.1, 0, 0, kGood}));
  // Near the command e'' = 4 w (-w e - e') is critically damped; steps of 2 w dt = 4 %.
  PlatformGuard near{PlatformLimits{}};
  for (int n = 1; n <= 100; ++n) {
    const double along = 40.0 * n * kDt_s;
    ASSERT_NEAR(1e-3 - near.step(asking(1e-3, 0, 0)).position_m,
                1e-3 * (1.0 + along) * std::exp(-along), 3e-5);
  }
}

// After an outage of any length within a moving trial the motion is caught up with.  Time allowed:
// crossing the whole travel, 0.3 m, with the profile's bend 1.5 m/s^2 takes 2 sqrt(0.3/1.5) = 0.9
// s, and the exponential tail from its linear start 3.75e-3 m to 2e-7 m ln(2e4)/20 = 0.5 s; doubled
// because the acceleration left over by the trajectory itself may be small for half its cycle.
TEST(PlatformGuardTest, AfterAnOutageTheTrajectoryIsCaughtUpWithExactly) {
  const auto trajectory = noise(5, 2.0, 1.6, 7.5, 40'000);
  int outages = 0;
  for (Tick outage = 2'000; outage < 36'000; outage += 1'700) {
    PlatformGuard sut{PlatformLimits{}};
    for (Tick i = 0; i < outage; ++i) sut.step({true, trajectory.at(i)});
    for (Tick i = outage; i < outage + 500; ++i) sut.step({});
    Tick caught = 0;
    for (Tick i = outage + 500; i < outage + 500 + 2'800; ++i) {
      if (same_bits(sut.step({true, trajectory.at(i)}), trajectory.at(i))) {
        ++caught;
      } else {
        ASSERT_EQ(caught, 0) << "lost again at " << i;
      }
    }
    ASSERT_GT(caught, 0) << "outage at " << outage;
    ++outages;
  }
  EXPECT_EQ(outages, 20);
}

TEST(PlatformGuardTest, FlagsOfTheCommandArePassedOn) {
  PlatformGuard sut{PlatformLimits{}};
  EXPECT_EQ(sut.step({true, {0, 0, 0, kInputGap}}).flags, kInputGap);
  EXPECT_EQ(sut.step({true, {0.1, 0, 0, kInputGap}}).flags, kInputGap | kWorkspaceLimit);
}

TEST(PlatformGuardTest, LimitsBeyondTheApparatusAreRefused) {
  PlatformLimits limits{.max_position_m = 0.16};
  EXPECT_THROW(PlatformGuard{limits}, ConfigError);
  limits.max_position_m = std::nan("");
  EXPECT_THROW(PlatformGuard{limits}, ConfigError);
}

}  // namespace stillhand::motion::platform_guard_test
