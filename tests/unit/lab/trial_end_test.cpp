// SPDX-License-Identifier: Apache-2.0
// What ends a trial before its last tick.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/lab/trial_run_fixture.hpp"

namespace stillhand::lab::trial_end_test {
namespace {

TEST_F(TrialRunTest, AnOpenInterlockEndsTheTrialOnceTheForceIsZeroAndRecorded) {
  follow();
  event(EventKind::kInterlockOpened, "rig", "peer gone");
  EXPECT_FALSE(step().announce.has_value());
  EXPECT_FALSE(seen_.trial_runs);
  step(1 * kSecond);
  EXPECT_FALSE(sut_->over());
  event(EventKind::kForceZero, "rig");
  // The motion ends with the force, not with what is looked for afterwards.
  const Actions zero = step();
  ASSERT_TRUE(zero.announce.has_value());
  EXPECT_FALSE(zero.announce->trial.has_value());
  EXPECT_FALSE(sut_->over());
  rig_at(5300);
  step();  // recorded; a process that ended may be the better reason
  EXPECT_FALSE(sut_->over());
  step(3 * kSecond + 1);
  EXPECT_EQ(ending(), "rig: peer gone");
}

TEST_F(TrialRunTest, AProcessWhoseEndIsSeenAfterTheInterlockIsTheReason) {
  follow();
  event(EventKind::kInterlockOpened, "rig", "motion gone");
  event(EventKind::kForceZero, "rig");
  pass_afterwards();
  ASSERT_FALSE(sut_->over());
  end_of_process({"motion (pid 7) ended: exit status 1; it said: disk full", false, false}, *sut_);
  EXPECT_EQ(ending(), "motion (pid 7) ended: exit status 1; it said: disk full");
}

TEST_F(TrialRunTest, AForceWhoseEndIsNotReportedIsWaitedForNoLongerThanItsLimit) {
  follow();
  event(EventKind::kInterlockOpened, "rig", "peer gone");
  step();
  step(1500 * kMs);
  step(300 * kMs);
  step(3 * kSecond + 1);
  EXPECT_EQ(ending(), "rig: peer gone");
}

TEST_F(TrialRunTest, AStopEndsTheTrialAtOnceAndAsksForItAgain) {
  follow();
  EXPECT_EQ(ask(Action::kStop), "stop, asked by desk: the trial ends, a start runs it again");
  const Actions stopped = step();
  ASSERT_TRUE(stopped.announce.has_value());
  EXPECT_FALSE(stopped.announce->trial.has_value());
  EXPECT_EQ(stopped.announce->session, SessionState::kRunning);
  step(300 * kMs);
  ASSERT_TRUE(sut_->over());
  EXPECT_TRUE(result().stopped);
  EXPECT_FALSE(result().completed);
  EXPECT_EQ(result().aborted, "stopped, asked by desk");
  EXPECT_TRUE(seen_.requests.paused());

  // The next run waits for a start, and the old stop is not its own.
  planned_.number = 3;
  sut_ = std::make_unique<TrialRun>(planned_, roster_, trouble_);
  EXPECT_EQ(step().announce->session, SessionState::kPaused);
  ask(Action::kStart);
  rig_at(20000);
  EXPECT_EQ(step().assign->start_tick, 23000);
  arm(3);
  rig_at(30000);
  step();
  EXPECT_EQ(ending(), "completed");
}

TEST_F(TrialRunTest, AStopBehindTheLastTickIsTooLate) {
  follow();
  rig_at(kEnd);
  ask(Action::kStop);
  step();
  EXPECT_EQ(ending(), "completed");
  EXPECT_FALSE(result().stopped);
}

TEST_F(TrialRunTest, AnEmergencyStopEndsTheTrialAndAnnouncesThatNoneRuns) {
  follow();
  ask(Action::kEmergencyStop);
  const Actions stopped = step();
  ASSERT_TRUE(stopped.announce.has_value());
  EXPECT_FALSE(stopped.announce->trial.has_value());
  event(EventKind::kInterlockOpened, "rig", "emergency stop");
  event(EventKind::kForceZero, "rig");
  pass_afterwards();
  EXPECT_FALSE(result().stopped);
  EXPECT_EQ(ending(), "emergency stop, asked by desk");
}

TEST_F(TrialRunTest, AnInterruptionEndsTheMotionAndTheTrial) {
  follow();
  seen_.interrupted = true;
  EXPECT_FALSE(step().announce->trial.has_value());
  step(300 * kMs);
  EXPECT_EQ(ending(), "interrupted");
}

// Nobody reports that the force of a silent rig is zero.
TEST_F(TrialRunTest, ASilentRigEndsTheTrialAndTheMotion) {
  follow();
  seen_.ended = Death{"rig ended: its life sign is gone", false, true};
  EXPECT_FALSE(step().announce.has_value());
  EXPECT_FALSE(step().announce->trial.has_value());
  step(300 * kMs);
  EXPECT_EQ(ending(), "rig ended: its life sign is gone");
}

// The rig ends the force by itself: the trial stays announced, so that its end is recorded as such.
TEST_F(TrialRunTest, AProcessThatEndsIsTheReasonAndTheRigOpensItsInterlock) {
  follow();
  seen_.ended = Death{"motion (pid 7) ended: signal 9 (Killed)", false, false};
  step();
  EXPECT_FALSE(step().announce.has_value());
  EXPECT_FALSE(sut_->over());
  event(EventKind::kInterlockOpened, "rig", "motion gone");
  event(EventKind::kForceZero, "rig");
  pass_afterwards();
  EXPECT_EQ(ending(), "motion (pid 7) ended: signal 9 (Killed)");
}

// Twice what is left, 2 * 10 s, and 10 s.
TEST_F(TrialRunTest, ATrialOnASlowSampleClockEnds) {
  step();
  arm(2);
  step();
  for (Tick tick = 101; tick <= 130; ++tick) {
    rig_at(tick);
    step(kSecond);
  }
  EXPECT_FALSE(sut_->over());
  step();
  step(1500 * kMs);
  step(300 * kMs);
  EXPECT_EQ(ending(), "the trial did not end in time");
}

}  // namespace
}  // namespace stillhand::lab::trial_end_test
