// SPDX-License-Identifier: Apache-2.0
#include "services/core/motion/motion_generator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "services/core/contract/config_error.hpp"

namespace stillhand::motion::motion_generator_test {

constexpr Tick kStart = 5'000;
constexpr Tick kDuration = 8'000;
constexpr Tick kRamp = 1'000;

MotionTrajectory trajectory(std::uint64_t seed = 3) {
  MotionProfile profile;
  profile.kind = MotionKind::kBandNoise;
  profile.seed = seed;
  profile.duration_ticks = kDuration;
  profile.ramp_ticks = kRamp;
  return MotionTrajectory(profile, PlatformLimits{});
}

Trial trial() { return {0, TrialPhase::kTracking, kStart, kDuration, kRamp}; }

MotionGenerator armed() {
  MotionGenerator sut{MotionGenerator::Config{}};
  Trial planned = trial();
  planned.start_tick += 77;
  sut.arm(trajectory(), planned);
  sut.announce(trial());  // the same trial, at its own start
  return sut;
}

bool at_rest_in_the_middle(const PlatformCommand& c) {
  return c.position_m == 0.0 && c.velocity_m_s == 0.0 && c.acceleration_m_s2 == 0.0;
}

TEST(MotionGeneratorTest, TheTrialGetsItsTrajectoryAndEveryOtherTickTheMiddle) {
  auto sut = armed();
  const auto expected = trajectory();
  for (Tick tick = 0; tick < kStart + kDuration + 2 * kRamp; ++tick) {
    const PlatformCommand got = sut.step(tick);
    const PlatformCommand want =
        trial().covers(tick) ? expected.at(tick - kStart + kRamp) : PlatformCommand{};
    ASSERT_EQ(got.position_m, want.position_m) << "tick " << tick;
    ASSERT_EQ(got.velocity_m_s, want.velocity_m_s) << "tick " << tick;
    ASSERT_EQ(got.acceleration_m_s2, want.acceleration_m_s2) << "tick " << tick;
    ASSERT_EQ(got.flags, kGood) << "tick " << tick;
  }
}

TEST(MotionGeneratorTest, ArmedAnewItHandsTheOldTrajectoryBack) {
  auto sut = armed();
  auto fresh = trajectory(4);
  const double fresh_m = fresh.at(2'000).position_m;
  ASSERT_NE(trajectory().at(2'000).position_m, fresh_m);
  sut.arm(std::move(fresh), trial());
  EXPECT_EQ(sut.trajectory().at(2'000).position_m, fresh_m);
  // NOLINTNEXTLINE(bugprone-use-after-move): exchanged, not emptied
  EXPECT_EQ(fresh.at(2'000).position_m, trajectory().at(2'000).position_m);
}

TEST(MotionGeneratorTest, WithoutATrialItHoldsStill) {
  MotionGenerator sut{MotionGenerator::Config{}};
  for (Tick tick = 0; tick < 100; ++tick) ASSERT_TRUE(at_rest_in_the_middle(sut.step(tick)));
}

TEST(MotionGeneratorTest, AnAbortedTrialReturnsToTheMiddleWithinTheLimits) {
  auto sut = armed();
  Tick tick = 0;
  while (tick < kStart + 3'000) sut.step(tick++);
  ASSERT_GT(std::abs(sut.step(tick++).position_m), 1e-3);
  sut.announce(Trial{});
  PlatformCommand last = sut.step(tick++);
  EXPECT_TRUE((last.flags & kWorkspaceLimit) != 0u);
  for (int n = 0; n < 3'000; ++n) {
    const PlatformCommand now = sut.step(tick++);
    ASSERT_LE(std::abs(now.velocity_m_s - last.velocity_m_s), 9.0 * kControlPeriod_s + 1e-14);
    last = now;
  }
  EXPECT_TRUE(at_rest_in_the_middle(last));
  EXPECT_EQ(last.flags, kGood);
}

TEST(MotionGeneratorTest, ALostTickIsSteppedThroughAndFlagged) {
  auto sut = armed();
  const auto expected = trajectory();
  Tick tick = 0;
  while (tick <= kStart + 100) sut.step(tick++);
  tick += 7;
  const PlatformCommand got = sut.step(tick);
  EXPECT_EQ(got.position_m, expected.at(tick - kStart + kRamp).position_m);
  EXPECT_EQ(got.flags, kInputGap);
  EXPECT_EQ(sut.step(tick + 1).flags, kGood);
}

TEST(MotionGeneratorTest, ARepeatedTickRepeatsTheAnswer) {
  auto sut = armed();
  Tick tick = 0;
  while (tick <= kStart + 100) sut.step(tick++);
  const PlatformCommand first = sut.step(tick);
  const PlatformCommand again = sut.step(tick);
  EXPECT_EQ(first.position_m, again.position_m);
  EXPECT_EQ(sut.step(tick + 1).flags, kGood);
}

TEST(MotionGeneratorTest, AJumpOfTheClockStaysWithinTheLimits) {
  auto sut = armed();
  Tick tick = 0;
  while (tick <= kStart + 100) sut.step(tick++);
  const PlatformLimits limits;
  for (const Tick jump : {Tick{0}, kStart + 4'000, Tick{1}, std::numeric_limits<Tick>::max() / 2,
                          kStart, kStart + 4'001}) {
    const PlatformCommand got = sut.step(jump);
    EXPECT_TRUE((got.flags & kInputGap) != 0u) << jump;
    EXPECT_LE(std::abs(got.position_m), limits.max_position_m);
    EXPECT_LE(std::abs(got.velocity_m_s), limits.max_velocity_m_s);
    EXPECT_LE(std::abs(got.acceleration_m_s2), limits.max_acceleration_m_s2);
  }
}

TEST(MotionGeneratorTest, ATrialOfAnotherLengthOrAHostileStartIsRefused) {
  MotionGenerator sut{MotionGenerator::Config{}};
  Trial other = trial();
  other.duration_ticks += 1;
  EXPECT_THROW(sut.arm(trajectory(), other), ConfigError);
  other = trial();
  other.ramp_ticks -= 1;
  EXPECT_THROW(sut.arm(trajectory(), other), ConfigError);
  other = trial();
  other.start_tick = std::numeric_limits<Tick>::max();
  EXPECT_THROW(sut.arm(trajectory(), other), ConfigError);
  other.start_tick = -1;
  EXPECT_THROW(sut.arm(trajectory(), other), ConfigError);
}

}  // namespace stillhand::motion::motion_generator_test
