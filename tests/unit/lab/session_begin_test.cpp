// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/core/session_begin.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/lab/stage_fixture.hpp"

namespace stillhand::lab::session_begin_test {
namespace {

using testing::IsEmpty;

class MatchingTest : public StageTest {
 protected:
  Matching sut_{roster_, "domain 3 rig 1", 20.0, trouble_};
};

TEST_F(MatchingTest, IsCompleteOnceEveryProcessAndEveryPeerHasMatched) {
  seen_.missing_peers = {"rig (stillhand/event)"};
  EXPECT_EQ(step(sut_).progress->done, 1.0);
  EXPECT_FALSE(sut_.over());
  seen_.missing_peers.clear();
  step(sut_);
  EXPECT_TRUE(sut_.complete());
  EXPECT_EQ(failure_of(sut_), "");
}

TEST_F(MatchingTest, NamesTheProcessesThatAreMissingWhenTheTimeIsOver) {
  seen_.processes.erase("recorder");
  seen_.processes["rig"].matched = false;
  seen_.processes["rig"].missing = "motion (stillhand/platform_command)";
  seen_.missing_peers = {"recorder (stillhand/event)"};
  EXPECT_EQ(step(sut_).progress->done, 0.5);
  step(sut_, 20 * kSecond);
  EXPECT_FALSE(sut_.over());
  step(sut_, 1);
  EXPECT_FALSE(sut_.complete());
  EXPECT_EQ(failure_of(sut_),
            "not every process was ready within 20 s: "
            "rig waits for motion (stillhand/platform_command), recorder is not on the bus, "
            "experiment waits for recorder (stillhand/event)");
}

TEST_F(MatchingTest, OfManyThatAreMissingTheFirstAreNamedAndTheRestCounted) {
  seen_.processes.clear();
  seen_.missing_peers.assign(30, "rig (stillhand/event)");
  step(sut_);
  step(sut_, 20 * kSecond + 1);
  EXPECT_THAT(sut_.failure(), testing::HasSubstr("rig is not on the bus"));
  EXPECT_THAT(sut_.failure(), testing::ContainsRegex(", and 2[0-9] more$"));
  EXPECT_LT(sut_.failure().size(), 500U);
}

TEST_F(MatchingTest, ASecondLabOnTheSameBusIsAFailureEvenWhenEverybodyMatched) {
  seen_.duplicate_peers = {"motion", "rig"};
  step(sut_);
  EXPECT_EQ(failure_of(sut_),
            "on domain 3 rig 1 there is more than one motion, rig: another lab runs; choose "
            "another --domain or --rig");
}

TEST_F(MatchingTest, AProcessThatRefusesItsSettingsEndsTheWaitWithItsOwnLine) {
  seen_.processes.erase("rig");
  end_of_process({"stillhand-rig: rig.yaml:1: settings without end", true, false}, sut_);
  EXPECT_FALSE(sut_.complete());
  EXPECT_EQ(failure_of(sut_), "");
  EXPECT_TRUE(trouble_.refused());
  EXPECT_EQ(trouble_.why(), "stillhand-rig: rig.yaml:1: settings without end");
}

TEST_F(MatchingTest, AnInterruptionEndsTheWaitWithoutAFailure) {
  seen_.processes.erase("rig");
  seen_.interrupted = true;
  step(sut_);
  EXPECT_FALSE(sut_.complete());
  EXPECT_EQ(failure_of(sut_), "");
}

// Ctrl-C also reaches a process that is just starting.
TEST_F(MatchingTest, AProcessThatTheInterruptionEndedIsNoTrouble) {
  seen_.processes.erase("rig");
  seen_.ended = Death{"rig (pid 7) ended: signal 2 (Interrupt)", false, false};
  step(sut_);
  EXPECT_FALSE(sut_.over());
  seen_.interrupted = true;
  step(sut_);
  EXPECT_TRUE(sut_.over());
  EXPECT_THAT(trouble_.why(), IsEmpty());
  EXPECT_EQ(trouble_.why_stopped(seen_, "late"), "interrupted");
}

class ClockStartTest : public StageTest {
 protected:
  ClockStartTest() {
    for (auto& [name, process] : seen_.processes) process.tick = -1;
  }
  ClockStart sut_{roster_, trouble_};
};

TEST_F(ClockStartTest, AnnouncesTheSessionAndWaitsForTheTicksOfThoseThatCountThem) {
  const Actions first = step(sut_);
  ASSERT_TRUE(first.announce.has_value());
  EXPECT_EQ(first.announce->session, SessionState::kRunning);
  EXPECT_FALSE(first.announce->trial.has_value());
  EXPECT_FALSE(step(sut_).announce.has_value());
  for (const char* name : {"rig", "cancellation"}) seen_.processes[name].tick = 0;
  step(sut_);
  EXPECT_FALSE(sut_.over());
  seen_.processes["recorder"].tick = 0;  // human_operator counts none before a trial
  step(sut_);
  EXPECT_EQ(failure_of(sut_), "");
}

TEST_F(ClockStartTest, AClockThatStandsIsAFailureAfterFiveSeconds) {
  EXPECT_EQ(failure_after(sut_, 5 * kSecond), "the sample clock did not start within 5 s");
}

TEST_F(ClockStartTest, AProcessThatEndsIsTroubleAndNoFailureOfTheClock) {
  step(sut_);
  end_of_process({"rig (pid 7) ended: signal 9 (Killed)", false, false}, sut_);
  EXPECT_EQ(failure_of(sut_), "");
  EXPECT_EQ(trouble_.why(), "rig (pid 7) ended: signal 9 (Killed)");
}

}  // namespace
}  // namespace stillhand::lab::session_begin_test
