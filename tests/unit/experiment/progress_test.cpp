// SPDX-License-Identifier: Apache-2.0
// A journal is cut after every line and after every byte of its last line: what remains of the
// protocol is what the whole lines left undone.
#include "apps/libraries/experiment/core/progress.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "apps/libraries/experiment/core/seeds.hpp"
#include "apps/libraries/experiment/file/journal.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/recording/file_io.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::experiment::progress_test {
namespace {

using testing::HasSubstr;

Design every_kind_of_step() {
  Design design;
  design.blocks = 2;
  design.practice.most_trials = 3;
  design.practice.dwell_ratio = 0.4;
  for (const auto after : {Question::After::kPractice, Question::After::kTrial,
                           Question::After::kBlock, Question::After::kEnd}) {
    design.questions.push_back({name_of(after), after, "how?", "low", "high", 7});
  }
  return design;
}

// The entries that a participant's session writes for one step, without a crash.
void do_step(const Plan& plan, std::size_t step, std::vector<Entry>& entries) {
  Entry entry{.session = 1, .step = static_cast<std::int64_t>(step)};
  const auto add = [&](EntryKind kind) {
    entry.kind = kind;
    entries.push_back(entry);
  };
  switch (plan[step].kind) {
    case StepKind::kQuestion:
      entry.answer = 3;
      return add(EntryKind::kQuestionAnswered);
    case StepKind::kBreak:
      return add(EntryKind::kBreakOver);
    case StepKind::kPractice:
      for (const double dwell : {0.3, 0.5}) {
        add(EntryKind::kTrialBegan);
        entry.completed = true;
        entry.dwell_ratio = dwell;
        add(EntryKind::kTrialEnded);
        entry.completed = false;
        entry.dwell_ratio.reset();
      }
      return;
    case StepKind::kTrial:
      add(EntryKind::kTrialBegan);
      entry.completed = true;
      return add(EntryKind::kTrialEnded);
  }
}

class ProgressTest : public testing::Test {
 protected:
  [[nodiscard]] Progress progress(const std::vector<Entry>& entries) const {
    Progress sut(design_, plan_);
    for (const Entry& entry : entries) sut.take(entry);
    return sut;
  }
  [[nodiscard]] static Entry session(std::int64_t number) {
    return {.kind = EntryKind::kSessionBegan, .session = number, .digest = "d"};
  }

  Design design_ = every_kind_of_step();
  Assignment assignment_{9};
  Plan plan_ = plan_of(design_, assignment_, 4);
};

TEST_F(ProgressTest, ThePlanHasTheStepsInTheirOrder) {
  EXPECT_EQ(trials_of(plan_), 6);
  EXPECT_EQ(plan_.front().kind, StepKind::kPractice);
  EXPECT_EQ(plan_.front().block, 0);
  EXPECT_EQ(plan_.back().kind, StepKind::kQuestion);
  // practice, its question, two blocks of three trials with a question each and one of the block,
  // a break, the last question
  EXPECT_EQ(plan_.size(), 2u + 2u * (3u * 2u + 1u) + 1u + 1u);
}

TEST_F(ProgressTest, AtEveryStepTheNextOneIsTheFirstThatIsNotDone) {
  std::vector<Entry> entries{session(1)};
  for (std::size_t step = 0; step < plan_.size(); ++step) {
    ASSERT_EQ(progress(entries).next(), step);
    do_step(plan_, step, entries);
  }
  EXPECT_TRUE(progress(entries).complete());
}

// The journal as a file, cut anywhere: no cut is refused, loses a whole line, or makes a step done
// whose line is not whole.
TEST_F(ProgressTest, AJournalThatIsCutAtAnyByteGoesOnWhereItsWholeLinesEnd) {
  std::vector<Entry> entries{session(1)};
  for (std::size_t step = 0; step < plan_.size(); ++step) do_step(plan_, step, entries);
  std::string text;
  std::vector<std::size_t> ends{0};
  std::vector<std::optional<std::size_t>> next{progress({}).next()};
  for (std::size_t i = 0; i < entries.size(); ++i) {
    text += line_of(entries[i]) + "\n";
    ends.push_back(text.size());
    next.push_back(progress({entries.begin(), entries.begin() + static_cast<long>(i) + 1}).next());
  }
  std::size_t whole = 0;
  for (std::size_t cut = 0; cut <= text.size(); ++cut) {
    if (whole + 1 < ends.size() && cut >= ends[whole + 1]) ++whole;
    const std::vector<Entry> sut = entries_of(text.substr(0, cut), "j");
    ASSERT_EQ(sut.size(), whole) << "cut at byte " << cut;
    ASSERT_EQ(progress(sut).next(), next[whole]) << "cut at byte " << cut;
  }
}

TEST_F(ProgressTest, AFileWithACutLineIsMendedAndContinued) {
  const support::Folder folder;
  const auto file = folder / "journal.jsonl";
  const std::string first = line_of({.kind = EntryKind::kNote, .time = "t", .text = "one"}) + "\n";
  const std::string second = line_of({.kind = EntryKind::kNote, .time = "t", .text = "two"}) + "\n";
  for (std::size_t cut = 0; cut < second.size(); ++cut) {
    std::ofstream(file, std::ios::trunc) << first << second.substr(0, cut);
    {
      Journal sut(file);
      ASSERT_EQ(sut.entries().size(), 1u);
      sut.append({.kind = EntryKind::kNote, .text = "three"});
    }
    const auto entries = entries_of(recording::read_file(file.string()), "j");
    ASSERT_EQ(entries.size(), 2u) << cut;
    EXPECT_EQ(entries[0].text, "one");
    EXPECT_EQ(entries[1].text, "three");
  }
}

TEST_F(ProgressTest, AJournalHasOneWriter) {
  const support::Folder folder;
  const auto file = folder / "journal.jsonl";
  {
    const Journal sut(file);
    EXPECT_THROW(Journal second(file), ConfigError);
  }
  EXPECT_NO_THROW(Journal third(file));
}

TEST_F(ProgressTest, EveryFieldOfAnEntryReadsBack) {
  const std::vector<Entry> entries{
      session(2),
      {.kind = EntryKind::kTrialBegan,
       .time = "t",
       .session = 2,
       .step = 3,
       .trial = 4,
       .label = "X"},
      {.kind = EntryKind::kTrialEnded,
       .time = "t",
       .session = 2,
       .step = 3,
       .trial = 4,
       .label = "X",
       .completed = true,
       .dwell_ratio = 0.1 + 0.2,
       .text = "why \"so\"\n"},
      {.kind = EntryKind::kQuestionAnswered, .step = 1, .answer = 7, .text = "effort"},
      {.kind = EntryKind::kSessionEnded, .session = 2, .completed = true},
      {.kind = EntryKind::kExcluded, .text = "withdrew"},
      {.kind = EntryKind::kUnblinded, .text = "fainted", .participant = "P05", .complete = 4}};
  std::string text;
  for (const Entry& entry : entries) text += line_of(entry) + "\n";
  EXPECT_EQ(entries_of(text, "j"), entries);
}

TEST_F(ProgressTest, ATrialThatWasStoppedOrRepeatedIsToBeDoneAgain) {
  std::vector<Entry> entries{session(1)};
  std::size_t step = 0;
  for (; plan_[step].kind != StepKind::kTrial; ++step) do_step(plan_, step, entries);
  const auto number = static_cast<std::int64_t>(step);
  entries.push_back({.kind = EntryKind::kTrialEnded, .step = number, .text = "stopped"});
  EXPECT_EQ(progress(entries).next(), step);
  do_step(plan_, step, entries);
  do_step(plan_, step + 1, entries);
  EXPECT_EQ(progress(entries).next(), step + 2);
  entries.push_back({.kind = EntryKind::kRepeatAsked, .step = number, .text = "coughed"});
  const Progress sut = progress(entries);
  EXPECT_EQ(sut.next(), step);
  EXPECT_EQ(sut.repeats(), 1);
  do_step(plan_, step, entries);
  EXPECT_EQ(progress(entries).next(), step + 2);  // the question after it stays answered
}

TEST_F(ProgressTest, PracticeEndsWithTheCriterionOrAfterTheMostTrials) {
  Entry entry{.kind = EntryKind::kTrialEnded, .step = 0, .completed = true};
  std::vector<Entry> entries;
  for (int trial = 0; trial < 3; ++trial) {
    EXPECT_EQ(progress(entries).next(), 0u);
    entry.dwell_ratio = 0.39;
    entries.push_back(entry);
  }
  EXPECT_EQ(progress(entries).next(), 1u);
  EXPECT_FALSE(progress(entries).practised());
  entry.dwell_ratio = 0.4;
  EXPECT_EQ(progress({entry}).next(), 1u);
  EXPECT_TRUE(progress({entry}).practised());
}

TEST_F(ProgressTest, AJournalThatWasChangedByHandIsRefused) {
  EXPECT_THROW(static_cast<void>(progress({session(2)})), ConfigError);  // a session is missing
  EXPECT_THROW(static_cast<void>(progress({{.kind = EntryKind::kBreakOver, .step = 0}})),
               ConfigError);
  for (const EntryKind kind : {EntryKind::kRepeatAsked, EntryKind::kTrialEnded}) {
    EXPECT_THROW(static_cast<void>(progress({{.kind = kind, .step = 99}})), ConfigError);
  }
  for (const std::string line : {"{}", "{\"time\":\"t\",\"what\":\"dance\"}", "x",
                                 "{\"time\":\"t\",\"what\":\"note\",\"name\":\"Ann\"}",
                                 "{\"time\":\"t\",\"what\":\"note\",\"step\":1.5}",
                                 "{\"time\":\"t\",\"what\":\"note\",\"step\":1e300}"}) {
    EXPECT_THAT(support::refusal([&] {
                  entries_of(line_of(session(1)) + "\n" + line + "\n", "P07/journal.jsonl");
                }),
                HasSubstr("P07/journal.jsonl:2"))
        << line;
  }
}

TEST_F(ProgressTest, ParticipantsDifferInSeedsUnlessTheyShareThem) {
  const Plan other = plan_of(design_, assignment_, 5);
  design_.same_motion_for_all = design_.same_target_for_all = true;
  const Plan shared = plan_of(design_, assignment_, 4), also = plan_of(design_, assignment_, 5);
  for (std::size_t i = 0; i < plan_.size(); ++i) {
    if (plan_[i].kind != StepKind::kTrial) continue;
    EXPECT_NE(plan_[i].motion_seed, other[i].motion_seed);
    EXPECT_NE(plan_[i].target_seed, other[i].target_seed);
    EXPECT_EQ(shared[i].motion_seed, also[i].motion_seed);
    EXPECT_EQ(shared[i].target_seed, also[i].target_seed);
  }
}

// Eq. EX-4; participants and places count from 1, what all share is of participant 0.
TEST_F(ProgressTest, EverySeedIsOfItsUseItsParticipantAndItsPlace) {
  design_.motion_seed = 11;
  design_.target_seed = 12;
  design_.subject_seed = 13;
  for (const std::uint64_t participant : {0u, 4u}) {
    design_.same_target_for_all = participant == 4;
    const std::uint64_t who = participant + 1, whose_target = participant == 4 ? 0 : who;
    std::uint64_t place = 0;
    for (const Step& step : plan_of(design_, assignment_, participant)) {
      if (step.kind != StepKind::kTrial) continue;
      ++place;
      EXPECT_EQ(step.place, static_cast<std::int64_t>(place));
      EXPECT_EQ(step.block, place <= 3 ? 1 : 2);
      EXPECT_EQ(step.motion_seed, derived_seed(11, SeedUse::kMotion, who, place));
      EXPECT_EQ(step.target_seed, derived_seed(12, SeedUse::kTarget, whose_target, place));
      const Step alone = trial_at_place(design_, participant, step.place);
      EXPECT_EQ(alone.motion_seed, step.motion_seed);
      EXPECT_EQ(alone.target_seed, step.target_seed);
    }
    EXPECT_EQ(place, 6u);
    // A practice trial is behind every place.
    EXPECT_EQ(practice_trial(design_, participant, 2).motion_seed,
              derived_seed(11, SeedUse::kMotion, who, 100'002));
    EXPECT_EQ(session_seed(design_, participant, 3), derived_seed(13, SeedUse::kSession, who, 3));
    EXPECT_EQ(identification_seed(design_, participant, 3),
              derived_seed(11, SeedUse::kIdentification, who, 3));
  }
}

// Two blocks of two passes are four rows of the square, from the participant's own on.
TEST_F(ProgressTest, EachPassOfABlockIsTheNextRowOfTheSquare) {
  design_.order = Order::kLatin;
  design_.trials = 2;
  design_.practice.most_trials = 0;
  std::vector<std::size_t> sut, rows;
  for (const Step& step : plan_of(design_, assignment_, 1)) {
    EXPECT_GE(step.block, 1);
    EXPECT_LE(step.block, step.kind == StepKind::kBreak ? 1 : 2) << "no break behind the last";
    if (step.kind == StepKind::kTrial) sut.push_back(step.condition);
  }
  for (std::size_t pass = 0; pass < 4; ++pass) {
    const auto row = condition_order(Order::kLatin, 3, assignment_.order_seed, 1, pass);
    rows.insert(rows.end(), row.begin(), row.end());
  }
  EXPECT_EQ(sut, rows);
}

TEST_F(ProgressTest, TrialsInARowAreWithoutOneBelowTheCriterionBetween) {
  design_.practice.in_a_row = 2;
  design_.practice.most_trials = 5;
  const auto reached = [&](const std::vector<double>& ratios) {
    std::vector<Entry> entries;
    for (const double ratio : ratios) {
      entries.push_back(
          {.kind = EntryKind::kTrialEnded, .step = 0, .completed = true, .dwell_ratio = ratio});
    }
    return progress(entries).practised();
  };
  EXPECT_FALSE(reached({0.4}));
  EXPECT_TRUE(reached({0.4, 0.4, 0.3}));
  EXPECT_FALSE(reached({0.4, 0.3, 0.4}));
}

}  // namespace
}  // namespace stillhand::experiment::progress_test
