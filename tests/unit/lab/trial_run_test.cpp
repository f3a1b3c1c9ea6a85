// SPDX-License-Identifier: Apache-2.0
// A trial from its announcement on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/lab/trial_run_fixture.hpp"

namespace stillhand::lab::trial_run_test {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

TEST_F(TrialRunTest, IsAssignedAndAnnouncedASecondAheadAndCompletedAtItsLastTick) {
  const Actions first = step();
  ASSERT_TRUE(first.assign && first.announce && first.announce->trial);
  EXPECT_EQ(first.assign->start_tick, kStart);
  EXPECT_EQ(first.announce->session, SessionState::kRunning);
  EXPECT_EQ(first.announce->trial->start_tick, kStart);
  EXPECT_TRUE(seen_.trial_runs);
  arm(2);
  rig_at(kStart + 2500);
  const Actions halfway = step();
  EXPECT_EQ(halfway.progress->what, "trial 2, tracking");
  EXPECT_EQ(halfway.progress->done, 0.5);
  rig_at(kEnd - 1);
  step();
  EXPECT_FALSE(sut_->over());
  rig_at(kEnd);
  EXPECT_FALSE(step().announce.has_value());
  EXPECT_EQ(ending(), "completed");
  EXPECT_FALSE(result().stopped);
  EXPECT_THAT(result().aborted, IsEmpty());
  EXPECT_EQ(result().trial.start_tick, kStart);
  EXPECT_FALSE(seen_.trial_runs);
}

// A platform may take seconds until it is engaged.
TEST_F(TrialRunTest, ATrialForWhichNotEverybodyIsPreparedBeginsLaterAndSaysSo) {
  constexpr Tick kBegin = kStart - 2000, kNotice = 300;
  step();
  arm(2);
  seen_.processes["rig"].armed_trial = -1;
  rig_at(kBegin - kNotice - 1);
  EXPECT_FALSE(step().announce);
  rig_at(kBegin - kNotice);
  const Actions later = step();
  ASSERT_TRUE(later.announce && later.announce->trial);
  EXPECT_FALSE(later.assign);
  EXPECT_EQ(later.announce->trial->number, 2);
  EXPECT_EQ(later.announce->trial->start_tick, kBegin - kNotice + 1000 + 2000);
  EXPECT_EQ(later.note, "trial 2 begins later: not everything is prepared yet");
  EXPECT_FALSE(step().announce);
  rig_at(1200);
  arm(2);
  step();
  rig_at(later.announce->trial->start_tick + 7000);
  step();
  EXPECT_EQ(ending(), "completed");
  EXPECT_EQ(result().trial.start_tick, later.announce->trial->start_tick);
}

// A seat that comes to its place moves before the trial does.
TEST_F(TrialRunTest, AStopWhileSomethingIsStillPreparedEndsTheTrial) {
  step();
  arm(2);
  seen_.processes["rig"].armed_trial = -1;
  EXPECT_FALSE(step().announce);
  ask(Action::kStop);
  const Actions stopped = step();
  ASSERT_TRUE(stopped.announce.has_value());
  EXPECT_FALSE(stopped.announce->trial.has_value());
  ASSERT_TRUE(sut_->over());
  EXPECT_TRUE(result().stopped);
}

// The conductor stood still, and all of its messages came at once.
TEST_F(TrialRunTest, ATrialThatBeganBeforeEverybodyWasPreparedIsNotCompleted) {
  constexpr Tick kBegin = kStart - 2000;
  for (const Tick prepared : {kBegin - 1, kBegin}) {
    sut_ = std::make_unique<TrialRun>(planned_, roster_, trouble_);
    rig_at(100);
    arm(-1);
    step();
    arm(2);
    seen_.processes["cancellation"].armed_trial = -1;
    for (const Tick tick : {prepared, Tick{9500}}) {
      ProcessSeen status;
      status.armed_trial = 2;
      status.tick = tick;
      seen_.take("cancellation", status);
    }
    rig_at(9500);
    step();
    EXPECT_EQ(sut_->over(), prepared == kBegin);
    if (!sut_->over()) continue;
    EXPECT_FALSE(result().completed);
    EXPECT_EQ(result().aborted,
              "cancellation was prepared at tick 1100, after the trial began at 1100");
  }
}

// What the recorder did not get is not in the recording.
TEST_F(TrialRunTest, ATrialIsOverWhenItsEndIsRecorded) {
  follow();
  rig_at(kEnd);
  seen_.processes["recorder"].tick = kEnd - 1;
  step();
  EXPECT_FALSE(sut_->over());
  seen_.processes["recorder"].tick = kEnd;
  step();
  EXPECT_EQ(ending(), "completed");
}

// Its life sign comes from another thread than its work.
TEST_F(TrialRunTest, AProcessThatStandsStillEndsTheTrialAndIsNamed) {
  follow();
  rig_at(7000);
  seen_.processes["cancellation"].tick = 6000;
  step();
  EXPECT_FALSE(sut_->over());
  rig_at(7001);
  // The operator has no input any more, and stands as well.
  seen_.processes["cancellation"].tick = seen_.processes["human_operator"].tick = 6000;
  const Actions actions = step();
  ASSERT_TRUE(actions.announce);
  EXPECT_FALSE(actions.announce->trial);  // command and motion end at their sources
  pass_afterwards();
  EXPECT_FALSE(result().stopped);
  EXPECT_EQ(ending(), "cancellation stands still: its newest tick is 6000, the rig's 7001");
}

TEST_F(TrialRunTest, ASampleClockThatStandsStillEndsTheTrial) {
  follow();
  step(4 * kSecond);
  EXPECT_FALSE(sut_->over());
  step();
  pass_afterwards();
  EXPECT_EQ(ending(), "rig stands still: no tick for 4 s");
}

TEST_F(TrialRunTest, APeggedTrialIsCalledIdentification) {
  planned_.phase = TrialPhase::kPegged;
  sut_ = std::make_unique<TrialRun>(planned_, roster_, trouble_);
  step();
  arm(2);
  EXPECT_EQ(step().progress->what, "identification, stick pegged");
}

TEST_F(TrialRunTest, CollectsTheEventsAndMissesOfItsOwnTimeAlone) {
  event(EventKind::kOther, "rig", "before");
  seen_.processes["rig"].misses = {1, 2, 3};
  seen_.processes["recorder"].misses = {10, 20, 30};
  step();
  arm(2);
  event(EventKind::kOther, "rig", "during");
  seen_.processes["rig"].misses = {2, 4, 6};
  rig_at(kEnd);
  step();
  ASSERT_TRUE(sut_->over());
  ASSERT_THAT(result().events, SizeIs(1));
  EXPECT_EQ(result().events[0].text, "during");
  EXPECT_EQ(result().misses.deadline, 1);
  EXPECT_EQ(result().misses.cycle, 2);
  EXPECT_EQ(result().misses.lost_ticks, 3);
}

TEST_F(TrialRunTest, WaitsOutAPauseThatIsAnnouncedOnce) {
  ask(Action::kPause);
  const Actions paused = step();
  ASSERT_TRUE(paused.announce.has_value());
  EXPECT_EQ(paused.announce->session, SessionState::kPaused);
  EXPECT_EQ(paused.progress->what, "paused before trial 2, for a start from the dashboard");
  EXPECT_FALSE(step(3600 * kSecond).announce.has_value());
  EXPECT_FALSE(seen_.trial_runs);
  ask(Action::kStart);
  EXPECT_TRUE(step().assign.has_value());
  EXPECT_TRUE(seen_.trial_runs);
}

TEST_F(TrialRunTest, AnInterruptionEndsAPauseBeforeTheTrial) {
  ask(Action::kPause);
  step();
  event(EventKind::kOther, "rig");
  seen_.interrupted = true;
  step();
  EXPECT_EQ(ending(), "interrupted");
  EXPECT_THAT(result().events, IsEmpty());
}

TEST_F(TrialRunTest, AnEmergencyStopBeforeTheTrialKeepsItFromBeginning) {
  ask(Action::kEmergencyStop);
  EXPECT_FALSE(step().assign.has_value());
  EXPECT_EQ(ending(), "emergency stop, asked by desk");
}

TEST_F(TrialRunTest, AProcessThatIsNotPreparedInTimeIsNamedWithItsNotes) {
  step();
  arm(2);
  seen_.processes["cancellation"].armed_trial = 1;
  seen_.processes["human_operator"].armed_trial = -1;
  event(EventKind::kNote, "cancellation", "model gain is above the bound");
  event(EventKind::kNote, "rig", "of no interest");
  step(10 * kSecond - 50 * kMs);
  EXPECT_FALSE(sut_->over());
  rig_at(10'000);
  step(51 * kMs);
  EXPECT_EQ(ending(),
            "cancellation was not prepared within 10 s (model gain is above the bound); "
            "human_operator was not prepared within 10 s");
}

TEST_F(TrialRunTest, AProcessThatIsPreparedLateButInTimeIsWaitedFor) {
  step();
  arm(2);
  seen_.processes["rig"].armed_trial = 1;
  step(9 * kSecond);
  EXPECT_FALSE(sut_->over());
  arm(2);
  rig_at(kStart);
  EXPECT_EQ(step().progress->what, "trial 2, tracking");
}

TEST_F(TrialRunTest, AProcessThatIsPreparedAndStandsStillIsWaitedForAndThenNamed) {
  rig_at(5000);
  step();
  arm(2);
  seen_.processes["cancellation"].tick = 3000;
  step(9 * kSecond);
  EXPECT_FALSE(sut_->over());
  seen_.processes["rig"].tick = 15'000;
  step(1 * kSecond + 1);
  EXPECT_EQ(ending(), "cancellation stands still: its newest tick is 3000, the rig's 15000");
}

TEST_F(TrialRunTest, AProcessThatStandsStillIsNamedInThePlaceOfThoseThatWaitForItsSamples) {
  rig_at(5000);
  step();
  arm(2);
  seen_.processes["cancellation"].tick = 3000;
  seen_.processes["human_operator"].armed_trial = 1;
  seen_.processes["rig"].tick = 15'000;
  step(10 * kSecond + 1);
  EXPECT_EQ(ending(), "cancellation stands still: its newest tick is 3000, the rig's 15000");
}

TEST_F(TrialRunTest, AProcessThatIsNotOnTheBusIsNotPrepared) {
  planned_.number = 0;
  sut_ = std::make_unique<TrialRun>(planned_, roster_, trouble_);
  step();
  arm(0);
  seen_.processes.erase("cancellation");
  rig_at(10'000);
  step(10 * kSecond + 1);
  EXPECT_EQ(ending(), "cancellation has handled no tick, the rig's is 10000");
}

TEST_F(TrialRunTest, AProcessThatEndsWhileOthersPrepareIsTheReason) {
  step();
  end_of_process({"display (pid 7) ended: signal 9 (Killed)", false, false}, *sut_);
  EXPECT_EQ(ending(), "display (pid 7) ended: signal 9 (Killed)");
}

TEST_F(TrialRunTest, AnInterlockThatOpensWhileOthersPrepareIsTheReason) {
  step();
  seen_.processes["display"].armed_trial = -1;
  event(EventKind::kInterlockOpened, "rig", "a process is missing: sensing");
  // A process that is prepared does not begin.
  const Actions opened = step();
  ASSERT_TRUE(opened.announce.has_value());
  EXPECT_FALSE(opened.announce->trial.has_value());
  EXPECT_FALSE(sut_->over());  // its end may be seen later
  step(3 * kSecond + 1);
  EXPECT_EQ(ending(), "rig: a process is missing: sensing");
}

}  // namespace
}  // namespace stillhand::lab::trial_run_test
