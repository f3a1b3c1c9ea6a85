// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/experiment/file/experiment_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>

#include "apps/experiment/export/bids_texts.hpp"
#include "apps/experiment/folder/sealed_assignment.hpp"
#include "services/core/contract/config_error.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::experiment::experiment_file_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string refusal(const std::string& yaml) {
  return support::refusal([&] { design_of(yaml, "experiment.yaml"); });
}

TEST(ExperimentFileTest, EveryKeyReadsBack) {
  Design design;
  design.title = "A \"title\": with: marks # and more";
  design.conditions = {"C'", "A", "C+", "C"};
  design.comparisons = {"A-C'", "C-C+"};
  design.control_model = "control_model.json";
  design.order = Order::kLatin;
  design.trial_s = 20.0 / 3.0;
  design.practice.most_trials = 4;
  design.exclusion.most_lost_tick_share = 0.125;
  design.exclusion.most_rms_deviations = 2.5;
  design.exclusion.most_broken_trials = 3;
  design.instructions = {"one", "two: \"quoted\""};
  design.questions = {{"effort", Question::After::kBlock, "How hard was it?", "easy", "hard", 7},
                      {"sick", Question::After::kTrial, "Do you feel sick?", "no", "very", 5}};
  design.assignment = std::string(64, 'a');
  const std::string yaml = yaml_of(design);
  const Design sut = design_of(yaml, "experiment.yaml");
  EXPECT_EQ(yaml_of(sut), yaml);
  EXPECT_EQ(sut.title, design.title);
  EXPECT_EQ(sut.conditions, design.conditions);
  EXPECT_EQ(sut.comparisons, design.comparisons);
  EXPECT_EQ(sut.order, design.order);
  EXPECT_EQ(sut.trial_s, design.trial_s);
  EXPECT_EQ(sut.practice.most_trials, 4);
  EXPECT_EQ(sut.exclusion.most_lost_tick_share, 0.125);
  EXPECT_EQ(sut.exclusion.most_rms_deviations, 2.5);
  EXPECT_EQ(sut.exclusion.most_broken_trials, 3);
  EXPECT_EQ(sut.instructions, design.instructions);
  ASSERT_EQ(sut.questions.size(), 2u);
  EXPECT_EQ(sut.questions[1].after, Question::After::kTrial);
  EXPECT_EQ(sut.questions[1].steps, 5);
}

TEST(ExperimentFileTest, WhatNoSessionCanRunIsNamed) {
  EXPECT_THAT(refusal("conditions: [A, D]"), HasSubstr("D runs in one process alone"));
  EXPECT_THAT(refusal("conditions: [A, G]"), StartsWith("experiment.yaml: conditions: got \"G\""));
  EXPECT_THAT(refusal("conditions: [A, A]"), HasSubstr("A twice"));
  EXPECT_THAT(refusal("conditions: []"), HasSubstr("nothing"));
  EXPECT_THAT(refusal("conditions: A"), HasSubstr("a list"));
  EXPECT_THAT(refusal("conditions: [B, scheduled]"), HasSubstr("two arms of each participant"));
  EXPECT_THAT(refusal("comparisons: [A-B, B-A]"), HasSubstr("\"B-A\" twice"));
  EXPECT_THAT(refusal("conditions: [B, C', signal]"), HasSubstr("signal with C' or C+"));
  EXPECT_THAT(refusal("conditions: [B, low-pass]\ncomparisons: [B-low]"), HasSubstr("\"B-low\""));
  EXPECT_THAT(refusal("conditions: [A, C+]\ncomparisons: []"), HasSubstr("control_model"));
  EXPECT_THAT(refusal("comparisons: [A-D]"), HasSubstr("A-D"));
  EXPECT_THAT(
      refusal("order: zigzag"),
      StartsWith("experiment.yaml:1:8: order: got \"zigzag\", want random, latin or williams"));
  EXPECT_THAT(refusal("operator: cat"), HasSubstr("simulated, mouse or gamepad"));
  EXPECT_THAT(refusal("blocks: 0"), HasSubstr("experiment.yaml:1:9"));
  EXPECT_THAT(refusal("blokcs: 1"), HasSubstr("blokcs"));
  EXPECT_THAT(refusal("questions: [{name: a b, text: t}]"), HasSubstr("letters"));
  // What the topic cannot carry, and what would be several lines on the screen.
  const std::string hundred_and_one(101, 'm');
  EXPECT_THAT(refusal("instructions: [" + hundred_and_one + "]"), HasSubstr("100 bytes"));
  EXPECT_THAT(refusal("instructions: [a, b, c, d, e, f, g, h, i]"), HasSubstr("8 lines"));
  EXPECT_THAT(refusal("questions: [{name: a, text: \"one\\ntwo\"}]"), HasSubstr("one line"));
}

// The bounds of what the screen shows; a name is of letters, digits and _.
TEST(ExperimentFileTest, AQuestionKeepsTheBoundsOfTheScreen) {
  Design design;
  design.questions = {{"azAZ09_", Question::After::kEnd, std::string(100, 'm'), "", "", 9}};
  Question& sut = design.questions[0];
  sut.highest.assign(40, 'm');
  EXPECT_NO_THROW(check(design));
  for (const std::int64_t steps : {1, 2, 10}) {
    sut.steps = steps;
    EXPECT_EQ(support::refusal([&] { check(design); }) == "accepted", steps == 2) << steps;
  }
}

// A design of one question and one line, after a change.
bool passes(const std::function<void(Design&)>& change) {
  Design design;
  design.questions = {{"name", Question::After::kEnd, "text", "", "", 2}};
  design.instructions = {"line"};
  change(design);
  return support::refusal([&] { check(design); }) == "accepted";
}

TEST(ExperimentFileTest, TextsKeepTheirBoundsOnBothSides) {
  struct Bound {
    std::function<std::string&(Design&)> text;
    std::size_t least, most;
  };
  for (const auto& [text, least, most] :
       {Bound{[](Design& d) -> std::string& { return d.questions[0].name; }, 1, 40},
        Bound{[](Design& d) -> std::string& { return d.questions[0].text; }, 1, 100},
        Bound{[](Design& d) -> std::string& { return d.questions[0].lowest; }, 0, 40},
        Bound{[](Design& d) -> std::string& { return d.questions[0].highest; }, 0, 40},
        Bound{[](Design& d) -> std::string& { return d.instructions[0]; }, 0, 100}}) {
    for (const std::size_t size : {std::size_t{0}, std::size_t{1}, most, most + 1}) {
      EXPECT_EQ(passes([&](Design& design) { text(design).assign(size, 'm'); }),
                size >= least && size <= most)
          << most << ": " << size;
    }
    EXPECT_FALSE(passes([&](Design& design) { text(design) = "a\x1F"; }));
  }
  for (const char* name : {"/", ":", "@", "[", "`", "{"}) {
    EXPECT_FALSE(passes([&](Design& design) { design.questions[0].name = name; })) << name;
  }
  for (const std::size_t lines : {8u, 9u}) {
    EXPECT_EQ(passes([&](Design& design) { design.instructions.assign(lines, " "); }), lines == 8u);
  }
}

TEST(ExperimentFileTest, OnlyWhatASessionCanRunPassesByItsOwnName) {
  EXPECT_THAT(live_conditions(), StartsWith("A, B, C, C' or C+; or A, B, C and mitigations: "
                                            "low-pass, notch, "));
  const std::pair<std::vector<std::string>, bool> lists[]{
      {{"A", "B"}, true},      {{"A", "force"}, false}, {{"A", "P"}, false},
      {{"A", "signal"}, true}, {{"A", "C'"}, true},     {{"C'", "signal"}, false}};
  for (const auto& [conditions, good] : lists) {
    EXPECT_EQ(passes([&](Design& design) {
                design.conditions = conditions;
                design.comparisons.clear();
              }),
              good)
        << conditions[1];
  }
  for (const char* who : {"simulated", "mouse", "gamepad", "cat"}) {
    EXPECT_EQ(passes([&](Design& design) { design.who = who; }), std::string(who) != "cat") << who;
  }
  EXPECT_FALSE(passes([](Design& design) { design.control_model = kDiagnosed; })) << "without C+";
  EXPECT_FALSE(passes([](Design& design) { design.questions.push_back(design.questions[0]); }))
      << "one name twice";
}

TEST(ExperimentFileTest, ACodeIsACodeAndNeverAName) {
  EXPECT_EQ(participant_index("P07", 12), 6u);
  EXPECT_EQ(participant_index("P12", 12), 11u);
  EXPECT_EQ(participant_code(6), "P07");
  EXPECT_EQ(participant_index("P100", 120), 99u);
  for (const char* wrong : {"P7", "p07", "P007", "P13", "P00", "Ann", "", "P", "P07 ", "../P07"}) {
    EXPECT_THROW(participant_index(wrong, 12), ConfigError) << wrong;
  }
}

TEST(ExperimentFileTest, TheSealedFileGivesTheSeedBackAndDoesNotShowIt) {
  const std::string sealed = sealed_text(424242);
  EXPECT_EQ(order_seed_of(sealed, "s"), 424242u);
  const std::uint64_t longest = 18446744073709551557u;  // no double holds it
  EXPECT_EQ(order_seed_of(sealed_text(longest), "s"), longest);
  EXPECT_EQ(sealed.find("424242"), std::string::npos);
  EXPECT_NE(sealed, sealed_text(424242));  // a nonce: equal seeds do not show
  EXPECT_THROW(order_seed_of("zz", "s"), ConfigError);
  EXPECT_THROW(order_seed_of("", "s"), ConfigError);
  EXPECT_THROW(order_seed_of("7b226f726465725f73656564223a2d317d", "s"), ConfigError);  // of -1
}

TEST(ExperimentFileTest, TheOpenedFileNamesTheConditionOfEveryLabelAndTrial) {
  Design design;
  design.participants = 2;
  const Assignment assignment{5};
  const std::string text = opened_text(design, assignment);
  for (const char* word : {"\"X\"", "\"Y\"", "\"Z\"", "P01", "P02"}) {
    EXPECT_THAT(text, HasSubstr(word));
  }
}

TEST(ExperimentFileTest, EveryConditionOfAnExperimentHasALabel) {
  const std::size_t all = session::conditions_of(session::kExperimentConditions).size();
  const std::vector<std::string> labels = labels_of(all, Assignment{5}, 0);
  EXPECT_EQ(std::set<std::string>(labels.begin(), labels.end()).size(), all);
  for (const std::string& label : labels) {
    EXPECT_FALSE(session::condition_named(label)) << label;
  }
}

// Who recognises a trial of one participant must not know the others'.
TEST(ExperimentFileTest, EachParticipantHasLabelsOfItsOwn) {
  std::set<std::vector<std::string>> all;
  for (std::size_t participant = 0; participant < 24; ++participant) {
    std::vector<std::string> labels = labels_of(3, Assignment{5}, participant);
    EXPECT_EQ(labels, labels_of(3, Assignment{5}, participant));
    all.insert(labels);
    std::ranges::sort(labels);
    EXPECT_THAT(labels, testing::ElementsAre("X", "Y", "Z"));
  }
  EXPECT_GT(all.size(), 1u);
}

TEST(ExperimentFileTest, ACommandCanBeTypedIntoAShell) {
  EXPECT_EQ(command_for("run", "my study's"), "stillhand experiment run 'my study'\\''s'");
  EXPECT_EQ(command_for("unblind", "study1"), "stillhand experiment unblind study1 --reason TEXT");
}

// A mitigation's name may hold the dash that separates two conditions.
TEST(ExperimentFileTest, APlannedComparisonNamesTwoOfTheConditions) {
  const std::vector<std::string> conditions{"B", "low-pass", "damping+force", "lms-signal"};
  EXPECT_EQ(compared_by("B-low-pass", conditions), std::pair(std::string("B"), conditions[1]));
  EXPECT_EQ(compared_by("low-pass-lms-signal", conditions),
            std::pair(conditions[1], conditions[3]));
  EXPECT_EQ(compared_by("damping+force-B", conditions), std::pair(conditions[2], conditions[0]));
  for (const char* text : {"", "B", "B-", "-B", "B-B", "low-pass", "B-low", "B-C"}) {
    EXPECT_FALSE(compared_by(text, conditions)) << text;
  }
}

}  // namespace
}  // namespace stillhand::experiment::experiment_file_test
