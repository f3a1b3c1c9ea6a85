// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/core/trouble.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stillhand::lab::trouble_test {
namespace {

using testing::IsEmpty;

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kNow = 5000 * kMs;
constexpr std::int64_t kLimit = 6000 * kMs;

class TroubleTest : public testing::Test {
 protected:
  Wait wait(std::int64_t now_ns, bool over = false) {
    return sut_.wait(over, seen_, kLimit, now_ns);
  }
  void emergency() { seen_.requests.take({Action::kEmergencyStop, 1, "desk", ""}, true); }

  Seen seen_;
  Trouble sut_;
};

TEST_F(TroubleTest, AWaitGoesOnUntilItsLimitAndIsTooLongAfterIt) {
  EXPECT_EQ(wait(kLimit), Wait::kGoesOn);
  EXPECT_EQ(wait(kLimit + 1), Wait::kTooLong);
  EXPECT_EQ(wait(kLimit + 1, true), Wait::kOver);
  EXPECT_EQ(sut_.why_stopped(seen_, "late"), "late");
}

TEST_F(TroubleTest, ADeathCountsFiftyMillisecondsAfterItWasSeen) {
  seen_.ended = Death{"rig ended", false, false};
  EXPECT_EQ(wait(kNow), Wait::kGoesOn);
  EXPECT_TRUE(sut_.settles());
  EXPECT_EQ(wait(kNow + 50 * kMs - 1), Wait::kGoesOn);
  EXPECT_THAT(sut_.why(), IsEmpty());
  EXPECT_EQ(wait(kNow + 50 * kMs), Wait::kStopped);
  EXPECT_FALSE(sut_.settles());
  EXPECT_EQ(sut_.why(), "rig ended");
  EXPECT_FALSE(seen_.ended.has_value());  // taken
}

// Neither the end of the wait nor its limit hides a death that is being looked at.
TEST_F(TroubleTest, WhileADeathSettlesNothingElseCounts) {
  seen_.ended = Death{"rig ended", false, false};
  EXPECT_EQ(wait(kLimit - 1), Wait::kGoesOn);
  EXPECT_EQ(wait(kLimit + 10 * kMs, true), Wait::kGoesOn);
  EXPECT_EQ(wait(kLimit + 60 * kMs, true), Wait::kStopped);
}

TEST_F(TroubleTest, WhatIsThereCountsBeforeATroubleThatIsFirstSeenWithIt) {
  seen_.interrupted = true;
  seen_.ended = Death{"rig ended", false, false};
  EXPECT_EQ(wait(kNow, true), Wait::kOver);
  EXPECT_TRUE(seen_.ended.has_value());
}

TEST_F(TroubleTest, TroubleStaysForEveryLaterWait) {
  seen_.ended = Death{"stillhand-rig: bad settings", true, false};
  wait(kNow);
  wait(kNow + 50 * kMs);
  EXPECT_EQ(wait(kNow + 100 * kMs), Wait::kStopped);
  EXPECT_TRUE(sut_.refused());
  EXPECT_FALSE(sut_.silent());
  seen_.interrupted = true;
  EXPECT_EQ(sut_.why_stopped(seen_, "late"), "stillhand-rig: bad settings");
}

TEST_F(TroubleTest, ASilentProcessIsNotOneThatRefused) {
  seen_.ended = Death{"rig ended: its life sign is gone", false, true};
  wait(kNow);
  wait(kNow + 50 * kMs);
  EXPECT_TRUE(sut_.silent());
  EXPECT_FALSE(sut_.refused());
}

TEST_F(TroubleTest, ADeathThatAnInterruptionExplainsIsNone) {
  seen_.ended = Death{"rig ended: signal 2", false, true};
  wait(kNow);
  seen_.interrupted = true;
  EXPECT_EQ(wait(kNow + 50 * kMs), Wait::kStopped);
  EXPECT_THAT(sut_.why(), IsEmpty());
  EXPECT_FALSE(sut_.silent());
  EXPECT_EQ(sut_.why_stopped(seen_, "late"), "interrupted");
}

TEST_F(TroubleTest, AnEmergencyStopStopsAtOnceAndADeathAfterItIsTheReasonOnceItSettled) {
  emergency();
  EXPECT_EQ(wait(kNow), Wait::kStopped);
  EXPECT_EQ(sut_.why(), "emergency stop, asked by desk");
  seen_.ended = Death{"rig ended", false, false};
  EXPECT_EQ(wait(kNow + kMs), Wait::kGoesOn);
  EXPECT_EQ(wait(kNow + 51 * kMs), Wait::kStopped);
  EXPECT_EQ(sut_.why(), "rig ended");
}

TEST(SeenTest, AProcessThatWasNeverSeenHasNoTickAndIsNotPrepared) {
  const Seen sut;
  EXPECT_EQ(sut.newest_tick(), -1);
  EXPECT_EQ(sut.process("rig").armed_trial, -1);
  EXPECT_FALSE(sut.process("rig").matched);
  EXPECT_EQ(sut.misses().cycle, 0);
}

TEST(SeenTest, TheMissesAreThoseOfAllProcessesTogether) {
  Seen sut;
  sut.processes["rig"].misses = {1, 20, 300};
  sut.processes["sensing"].misses = {4, 50, 600};
  EXPECT_EQ(sut.misses().deadline, 5);
  EXPECT_EQ(sut.misses().cycle, 70);
  EXPECT_EQ(sut.misses().lost_ticks, 900);
}

}  // namespace
}  // namespace stillhand::lab::trouble_test
