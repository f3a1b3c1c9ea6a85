// SPDX-License-Identifier: Apache-2.0
#include "services/core/display/page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stillhand::display::page_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class PageTest : public testing::Test {
 protected:
  static Prompt prompt(PromptKind kind) {
    Prompt prompt;
    prompt.number = 1;
    prompt.kind = kind;
    prompt.trial = 4;
    prompt.trials = 12;
    return prompt;
  }
  static Prompt question(std::int64_t steps = 7) {
    Prompt asked = prompt(PromptKind::kQuestion);
    asked.lines = {"How hard was it?"};
    asked.lowest = "not at all";
    asked.highest = "very";
    asked.steps = steps;
    return asked;
  }
  /// The measured part of trial 9 of the recording: 10 s from tick 20000.
  static Moment at(Tick tick, TrialPhase phase = TrialPhase::kTracking) {
    return {tick, {9, phase, 20'000, 10'000, 2000}};
  }
  Page page(const Prompt& prompt, const Moment& moment) {
    return page_of(prompt, moment, answering_);
  }

  Answering answering_;
};

TEST_F(PageTest, WhileTrackingOnlyPlaceAndTimeAreShownNextToTheTask) {
  const Page shown = page(prompt(PromptKind::kTrial), at(23'400));
  EXPECT_TRUE(shown.task);
  EXPECT_EQ(shown.corner_left, "Trial 4 of 12");
  EXPECT_EQ(shown.corner_right, "0:07");
  Page rest = shown;
  rest.corner_left = rest.corner_right = "";
  EXPECT_EQ(rest, Page{});
}

// The platform engages from the announcement on, before the ramp of 2 s.
TEST_F(PageTest, WhileTheSeatComesToItsPlaceThePageSaysSo) {
  for (const TrialPhase phase : {TrialPhase::kPegged, TrialPhase::kTracking, TrialPhase::kFree}) {
    const Moment later = at(20'000, phase);
    const Tick begin = later.trial.start_tick - later.trial.ramp_ticks;
    for (const Tick tick : {begin - 1, begin}) {
      const bool comes = tick < begin;
      EXPECT_EQ(page(prompt(PromptKind::kTrial), at(tick, phase)).below,
                comes ? "The seat moves slowly to its place" : "");
    }
  }
}

// The stick is free and held still: the target stands in the centre.  Nothing waits before it, so
// what to do is on the screen from its announcement to its end; it is no trial of the protocol.
TEST_F(PageTest, AFreeStickIsHeldOverTheTaskWithItsInstructionsInView) {
  Prompt instructions = prompt(PromptKind::kInstructions);
  instructions.lines = {"Hold the stick still."};
  for (const Prompt& shows : {instructions, Prompt{}}) {
    const Page before = page(shows, at(18'500, TrialPhase::kFree));
    EXPECT_EQ(before.heading, "Measurement");
    EXPECT_EQ(before.large, "2");
    const Page shown = page(shows, at(23'400, TrialPhase::kFree));
    EXPECT_EQ(shown.heading, "");
    EXPECT_EQ(shown.corner_right, "0:07");
    const Page after = page(shows, at(30'000, TrialPhase::kFree));
    EXPECT_EQ(after.heading, "Over");
    EXPECT_THAT(after.lines, IsEmpty());
    for (const Page& each : {before, shown, after}) {
      EXPECT_TRUE(each.task);
      EXPECT_EQ(each.corner_left, "Measurement");
    }
    for (const Page& each : {before, shown}) {
      ASSERT_THAT(each.lines, Not(IsEmpty()));
      EXPECT_EQ(each.lines[0], "Hold the stick still.");
    }
  }
}

TEST_F(PageTest, ThreeTwoOneLeadsToTheFirstMeasuredTick) {
  for (const auto& [tick, number] :
       {std::pair{17'000, "3"}, {18'001, "2"}, {19'000, "1"}, {19'999, "1"}}) {
    const Page shown = page(prompt(PromptKind::kTrial), at(tick));
    EXPECT_EQ(shown.large, number) << tick;
    EXPECT_EQ(shown.heading, "Trial 4 of 12");
    EXPECT_TRUE(shown.task);
  }
  EXPECT_EQ(page(prompt(PromptKind::kTrial), at(20'000)).large, "");
}

TEST_F(PageTest, ARestCountsDownToTheSameInstant) {
  Prompt resting = prompt(PromptKind::kTrial);
  resting.end_tick = 90'000;
  EXPECT_EQ(page(resting, at(45'000)).large, "0:45");
  EXPECT_EQ(page(resting, at(79'500)).large, "0:11");
  EXPECT_EQ(page(resting, at(80'000)).large, "10");
  EXPECT_EQ(page(resting, at(85'500)).large, "5");
  EXPECT_EQ(page(resting, at(85'500)).caption, "begins in");
  EXPECT_THAT(page(resting, at(90'000)).lines, ElementsAre("Please wait"));
}

TEST_F(PageTest, APauseSaysWhoGoesOn) {
  Prompt resting = prompt(PromptKind::kTrial);
  resting.end_tick = 90'000;
  Moment moment = at(45'000);
  moment.paused = true;
  EXPECT_THAT(page(resting, moment).lines, ElementsAre(HasSubstr("the experimenter")));
  EXPECT_EQ(page(resting, moment).large, "");
}

TEST_F(PageTest, PracticeIsNamed) {
  EXPECT_EQ(page(prompt(PromptKind::kPractice), at(25'000)).corner_left, "Practice 4");
}

TEST_F(PageTest, WithoutAProtocolTheTrialHasTheNumberOfItsRecording) {
  EXPECT_EQ(page({}, at(25'000)).corner_left, "Trial 10");
  EXPECT_EQ(page({}, at(31'999)).heading, "Over");
  EXPECT_EQ(page({}, at(32'000)).heading, "Hold") << "behind the ramp";
}

TEST_F(PageTest, ThePeggedTrialSaysWhatToDoAndHowLong) {
  const Page shown = page(prompt(PromptKind::kIdentification), at(25'000, TrialPhase::kPegged));
  EXPECT_FALSE(shown.task);
  EXPECT_EQ(shown.large, "0:05");
  EXPECT_THAT(shown.lines, Not(IsEmpty()));
}

TEST_F(PageTest, InstructionsStandBeforeAndDuringThePeggedTrial) {
  Prompt instructions = prompt(PromptKind::kInstructions);
  instructions.lines = {"Keep the cross in the box.", "Any time."};
  for (const Moment& moment : {Moment{100, {}}, at(25'000, TrialPhase::kPegged)}) {
    EXPECT_EQ(page(instructions, moment).lines, instructions.lines);
    EXPECT_EQ(page(instructions, moment).heading, "What you will do");
    EXPECT_FALSE(page(instructions, moment).task);
  }
}

TEST_F(PageTest, ABreakShowsItsTimeAndWhatIsNext) {
  Prompt resting = prompt(PromptKind::kBreak);
  resting.end_tick = 155'000;
  const Page shown = page(resting, at(50'000));
  EXPECT_EQ(shown.heading, "Break");
  EXPECT_EQ(shown.large, "1:45");
  EXPECT_EQ(shown.below, "Next: trial 4 of 12");
  EXPECT_EQ(page(resting, at(200'000)).large, "0:00");
}

TEST_F(PageTest, AQuestionHasItsScaleAndTheButtonWorksOnceANumberIsChosen) {
  answering_.show(question());
  Page shown = page(question(), at(50'000));
  EXPECT_THAT(shown.lines, ElementsAre("How hard was it?"));
  EXPECT_EQ(shown.steps, 7);
  EXPECT_EQ(shown.lowest, "not at all");
  EXPECT_EQ(shown.highest, "very");
  EXPECT_FALSE(shown.button_works);
  answering_.choose(5);
  shown = page(question(), at(50'000));
  EXPECT_EQ(shown.chosen, 5);
  EXPECT_TRUE(shown.button_works);
  answering_.confirm();
  shown = page(question(), at(50'000));
  EXPECT_EQ(shown.button, "");
  EXPECT_EQ(shown.chosen, 5);
  EXPECT_EQ(shown.hint, "Thank you");
}

TEST_F(PageTest, GoingOnNeedsNoScale) {
  const Page shown = page(question(1), at(50'000));
  EXPECT_EQ(shown.steps, 0);
  EXPECT_EQ(shown.button, "Continue");
  EXPECT_TRUE(shown.button_works);
}

TEST_F(PageTest, WithAGamepadTheHintNamesItsButtons) {
  Moment moment = at(50'000);
  const auto hint = [&](std::int64_t steps) { return page(question(steps), moment).hint; };
  answering_.show(question());
  EXPECT_THAT(hint(1), Not(HasSubstr("(A)")));
  EXPECT_THAT(hint(7), Not(HasSubstr("left")));
  moment.gamepad = true;
  EXPECT_THAT(hint(1), HasSubstr("(A)"));
  EXPECT_THAT(hint(7), HasSubstr("left or right"));
  answering_.move(1);
  EXPECT_THAT(hint(7), HasSubstr("(A)"));
}

TEST_F(PageTest, TheEndThanks) {
  EXPECT_EQ(page(prompt(PromptKind::kEnd), at(50'000)).heading, "Thank you");
  EXPECT_EQ(page(prompt(PromptKind::kEnd), at(50'000)).button, "");
}

TEST_F(PageTest, AnOldPictureSaysSoWhateverIsAsked) {
  for (const PromptKind kind : {PromptKind::kTrial, PromptKind::kQuestion, PromptKind::kBreak}) {
    Moment moment = at(25'000);
    moment.fresh = false;
    EXPECT_EQ(page(prompt(kind), moment).heading, "Link lost");
  }
  EXPECT_EQ(page({}, {.fresh = false}).heading, "Please wait") << "no tick came yet";
}

TEST_F(PageTest, ARunningTrialHidesEveryOtherPrompt) {
  EXPECT_EQ(page(question(), at(25'000)).steps, 0);
  EXPECT_TRUE(page(question(), at(25'000)).task);
}

TEST(ClockTextTest, SecondsAreRoundedUp) {
  EXPECT_EQ(clock_text(170.2), "2:51");
  EXPECT_EQ(clock_text(0.0), "0:00");
  EXPECT_EQ(clock_text(-1.0), "0:00");
  EXPECT_EQ(clock_text(3600.0), "1:00:00");
  EXPECT_EQ(clock_text(1e300), "99:59:59");
}

}  // namespace stillhand::display::page_test
