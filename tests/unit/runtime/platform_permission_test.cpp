// SPDX-License-Identifier: Apache-2.0
#include "services/system/process/platform_permission.hpp"

#include <gtest/gtest.h>

namespace stillhand::runtime::platform_permission_test {
namespace {

// Covers 40 to 159; the measured part begins at 50.
Trial trial_number(std::int64_t number) { return {number, TrialPhase::kTracking, 50, 100, 10}; }
constexpr PlatformPermission::Input kGoodInput{.runs = true, .sound = true, .command = true};
constexpr PlatformPermission::Input kWrongInput{.runs = true, .sound = false, .command = true};

TEST(PlatformPermissionTest, WithoutATrialItHolds) {
  PlatformPermission sut;
  EXPECT_EQ(sut.step(Trial{}, 0, kGoodInput), MotionLeave::kHold);
  Trial idle = trial_number(1);
  idle.phase = TrialPhase::kIdle;
  EXPECT_EQ(sut.step(idle, 60, kGoodInput), MotionLeave::kHold);
}

TEST(PlatformPermissionTest, FromTheAnnouncementItEngagesAndFollowsWhereTheTrialCovers) {
  PlatformPermission sut;
  // At rest first: another trial may have moved until now.
  EXPECT_EQ(sut.step(trial_number(0), 0, kGoodInput), MotionLeave::kHold);
  EXPECT_EQ(sut.step(trial_number(0), 1, kGoodInput), MotionLeave::kEngage);
  EXPECT_EQ(sut.step(trial_number(0), 39, kGoodInput), MotionLeave::kEngage);
  EXPECT_EQ(sut.step(trial_number(0), 40, kGoodInput), MotionLeave::kFollow);
  EXPECT_EQ(sut.step(trial_number(0), 159, kGoodInput), MotionLeave::kFollow);
  EXPECT_EQ(sut.step(trial_number(0), 160, kGoodInput), MotionLeave::kHold);
}

TEST(PlatformPermissionTest, ATrialInPlaceOfAnotherOneBeginsAtRest) {
  PlatformPermission sut;
  sut.step(trial_number(0), 59, kGoodInput);
  EXPECT_EQ(sut.step(trial_number(0), 60, kGoodInput), MotionLeave::kFollow);
  EXPECT_EQ(sut.step(trial_number(1), 61, kGoodInput), MotionLeave::kHold);
  EXPECT_EQ(sut.step(trial_number(1), 62, kGoodInput), MotionLeave::kFollow);
}

TEST(PlatformPermissionTest, ASessionThatIsPausedOrNotBegunHolds) {
  PlatformPermission sut;
  PlatformPermission::Input input = kGoodInput;
  sut.step(trial_number(0), 59, input);
  input.runs = false;
  EXPECT_EQ(sut.step(trial_number(0), 60, input), MotionLeave::kHold);
  EXPECT_FALSE(sut.latched(trial_number(0)));
}

TEST(PlatformPermissionTest, WhatWentWrongWhileArmingIsWrongForTheTrial) {
  PlatformPermission sut;
  // Not right yet: it waits.
  for (Tick tick = -2; tick < 1; ++tick) {
    EXPECT_EQ(sut.step(trial_number(3), tick, kWrongInput), MotionLeave::kHold);
  }
  EXPECT_FALSE(sut.latched(trial_number(3)));
  EXPECT_EQ(sut.step(trial_number(3), 1, kGoodInput), MotionLeave::kEngage);
  // Right, then wrong, for one tick.
  EXPECT_EQ(sut.step(trial_number(3), 2, kWrongInput), MotionLeave::kHold);
  EXPECT_TRUE(sut.latched(trial_number(3)));
  for (Tick tick = 3; tick < 160; ++tick) {
    ASSERT_EQ(sut.step(trial_number(3), tick, kGoodInput), MotionLeave::kHold) << tick;
  }
  sut.step(trial_number(4), 2, kGoodInput);
  EXPECT_EQ(sut.step(trial_number(4), 3, kGoodInput), MotionLeave::kEngage);
}

TEST(PlatformPermissionTest, ATrialThatBeginsWithSomethingWrongIsLost) {
  PlatformPermission sut;
  sut.step(trial_number(3), 39, kWrongInput);
  EXPECT_EQ(sut.step(trial_number(3), 40, kWrongInput), MotionLeave::kHold);
  EXPECT_EQ(sut.step(trial_number(3), 41, kGoodInput), MotionLeave::kHold);
  EXPECT_FALSE(sut.motion_lost(trial_number(3)));
}

TEST(PlatformPermissionTest, ACommandMayBeMissingForAWhileAndThenMotionIsLostForTheTrial) {
  PlatformPermission sut;
  PlatformPermission::Input missing = kGoodInput;
  missing.command = false;
  Trial trial = trial_number(5);
  trial.duration_ticks = 1000;
  Tick tick = 39;
  sut.step(trial, tick++, kGoodInput);
  for (Tick i = 0; i < PlatformPermission::kMostMissing_ticks; ++i) {
    ASSERT_EQ(sut.step(trial, tick++, missing), MotionLeave::kFollow);
  }
  EXPECT_EQ(sut.step(trial, tick++, kGoodInput), MotionLeave::kFollow);
  for (Tick i = 0; i <= PlatformPermission::kMostMissing_ticks; ++i)
    sut.step(trial, tick++, missing);
  EXPECT_EQ(sut.step(trial, tick++, kGoodInput), MotionLeave::kHold);
  EXPECT_TRUE(sut.motion_lost(trial));
}

TEST(PlatformPermissionTest, AfterAStopItHoldsForGood) {
  PlatformPermission sut;
  sut.step(trial_number(0), 59, kGoodInput);
  sut.stop();
  EXPECT_EQ(sut.step(trial_number(0), 60, kGoodInput), MotionLeave::kHold);
  EXPECT_EQ(sut.step(trial_number(1), 60, kGoodInput), MotionLeave::kHold);
  EXPECT_TRUE(sut.latched(trial_number(1)));
}

}  // namespace
}  // namespace stillhand::runtime::platform_permission_test
