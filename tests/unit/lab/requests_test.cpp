// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/core/requests.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stillhand::lab::requests_test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

Command command(Action action, std::uint64_t request, const char* asker = "desk",
                const char* text = "") {
  return {action, request, asker, text, asker};
}

TEST(RequestsTest, APauseHoldsUntilAStart) {
  Requests sut;
  EXPECT_FALSE(sut.paused());
  EXPECT_THAT(sut.take(command(Action::kPause, 1), true),
              StartsWith("pause, asked by desk: after this trial"));
  EXPECT_TRUE(sut.paused());
  EXPECT_THAT(sut.trial_stopped(), IsEmpty());
  EXPECT_EQ(sut.take(command(Action::kStart, 2), false), "start, asked by desk");
  EXPECT_FALSE(sut.paused());
}

TEST(RequestsTest, AStopEndsTheTrialThatRunsAndPauses) {
  Requests sut;
  EXPECT_THAT(sut.take(command(Action::kStop, 1), true), HasSubstr("the trial ends"));
  EXPECT_EQ(sut.trial_stopped(), "stopped, asked by desk");
  EXPECT_TRUE(sut.paused());
  sut.begin_trial();
  EXPECT_THAT(sut.trial_stopped(), IsEmpty());
}

TEST(RequestsTest, AStopBetweenTrialsStopsNone) {
  Requests sut;
  EXPECT_THAT(sut.take(command(Action::kStop, 1), false), HasSubstr("no trial runs"));
  EXPECT_THAT(sut.trial_stopped(), IsEmpty());
  EXPECT_TRUE(sut.paused());
}

TEST(RequestsTest, TheSameRequestAndAnOlderOneAreHeardOnce) {
  Requests sut;
  EXPECT_THAT(sut.take(command(Action::kPause, 7), false), Not(IsEmpty()));
  EXPECT_THAT(sut.take(command(Action::kStart, 8), false), Not(IsEmpty()));
  EXPECT_THAT(sut.take(command(Action::kPause, 7), false), IsEmpty());
  EXPECT_FALSE(sut.paused());
  EXPECT_THAT(sut.take(command(Action::kPause, 7, "another"), false), Not(IsEmpty()));
}

// Anybody may call themselves the desk, with the largest number that there is.
TEST(RequestsTest, AStrangerWithTheSameNameKeepsNobodyFromBeingHeard) {
  Requests sut;
  Command stranger = command(Action::kNote, UINT64_MAX);
  stranger.sender = "a stranger";
  sut.take(stranger, true);
  EXPECT_THAT(sut.take(command(Action::kPause, 1), true), StartsWith("pause, asked by desk"));
  EXPECT_TRUE(sut.paused());
}

TEST(RequestsTest, AnEmergencyStopIsHeardWhateverItsNumberAndNeverTakenBack) {
  Requests sut;
  sut.take(command(Action::kPause, 100), true);
  EXPECT_EQ(sut.take(command(Action::kEmergencyStop, 1), true), "emergency stop, asked by desk");
  EXPECT_THAT(sut.take(command(Action::kEmergencyStop, 2), true), IsEmpty());
  sut.take(command(Action::kStart, 101), false);
  sut.begin_trial();
  EXPECT_EQ(sut.emergency(), "emergency stop, asked by desk");
}

TEST(RequestsTest, ARepetitionBetweenTrialsIsForTheScriptOnceAndHasItsReason) {
  Requests sut;
  const auto repeat = command(Action::kRepeat, 1, "desk", "coughed");
  EXPECT_THAT(sut.take(repeat, false), HasSubstr("the last trial runs again: coughed"));
  EXPECT_FALSE(sut.paused());
  EXPECT_EQ(sut.take_asked().repeat, "coughed");
  EXPECT_EQ(sut.take_asked().repeat, std::nullopt);
}

TEST(RequestsTest, ARepetitionDuringATrialStopsItWithTheReason) {
  Requests sut;
  const auto repeat = command(Action::kRepeat, 1, "desk", "slipped");
  EXPECT_THAT(sut.take(repeat, true), HasSubstr("a start runs it again"));
  EXPECT_EQ(sut.trial_stopped(), "repeated, asked by desk: slipped");
  EXPECT_TRUE(sut.paused());
  EXPECT_EQ(sut.take_asked().repeat, std::nullopt);  // the trial that was stopped is not done
}

TEST(RequestsTest, AnAbortIsNeverTakenBackAndNotesComeOnce) {
  Requests sut;
  sut.take(command(Action::kNote, 1, "desk", "window open"), true);
  EXPECT_THAT(sut.take(command(Action::kAbort, 2, "desk", "fire alarm"), true),
              HasSubstr("the session ends: fire alarm"));
  EXPECT_EQ(sut.aborted(), "aborted, asked by desk: fire alarm");
  EXPECT_EQ(sut.take_asked().notes, std::vector<std::string>{"desk: window open"});
  EXPECT_TRUE(sut.take_asked().notes.empty());
  EXPECT_EQ(sut.take_asked().aborted, "aborted, asked by desk: fire alarm");
}

TEST(RequestsTest, ANoteChangesNothing) {
  Requests sut;
  EXPECT_EQ(sut.take(command(Action::kNote, 1, "desk", "alarms acknowledged"), true),
            "desk: alarms acknowledged");
  EXPECT_FALSE(sut.paused());
}

TEST(RequestsTest, StrangersDoNotMakeARepeatedRequestCountAgain) {
  Requests sut;
  sut.take(command(Action::kStart, 1), false);
  for (int i = 0; i < 1000; ++i) {
    sut.take(command(Action::kUnknown, 1, ("stranger " + std::to_string(i)).c_str()), true);
    EXPECT_EQ(sut.take(command(Action::kStart, 1), false), "");
  }
  EXPECT_EQ(sut.starts(), 1);
}

// They come from the network and go to terminals.
TEST(RequestsTest, NamesAndActionsOfAnySortAreOneHarmlessLine) {
  Requests sut;
  EXPECT_EQ(sut.take(command(Action::kStart, 1, "\x1b[2J\nroot"), false),
            "start, asked by [2Jroot: nothing was paused");
  EXPECT_THAT(sut.take(command(Action::kUnknown, 2), true), HasSubstr("not done"));
  for (std::uint64_t i = 1; i < 1000; ++i) {
    sut.take(command(Action::kNote, i, ("stranger " + std::to_string(i)).c_str()), true);
  }
  EXPECT_FALSE(sut.paused());
}

}  // namespace
}  // namespace stillhand::lab::requests_test
