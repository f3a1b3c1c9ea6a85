// SPDX-License-Identifier: Apache-2.0
// The table of conditions, and the trials that follow from it.
#include "apps/libraries/session/core/conditions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "apps/libraries/session/protocol.hpp"
#include "services/core/admittance/arm_fit.hpp"
#include "services/core/cancellation/parts/recipe.hpp"
#include "services/core/contract/config_error.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::session::conditions_test {
namespace {

std::vector<PlannedTrial> planned(const std::string& conditions) {
  const ProtocolOptions options{.conditions = parse_conditions(conditions)};
  return plan(options);
}

std::string refusal(const std::string& text) {
  return support::refusal([&] { parse_conditions(text); });
}

TEST(ConditionsTest, NamesStandNextToLetters) {
  EXPECT_EQ(parse_conditions("A,B,C,signal,damping+force"),
            (std::vector<Condition>{Condition::kA, Condition::kB, Condition::kC, Condition::kSignal,
                                    Condition::kDampingForce}));
  EXPECT_EQ(parse_conditions("none,force"), (std::vector<Condition>{Condition::kB, Condition::kC}));
}

TEST(ConditionsTest, ASentenceSpellsOutWhatNobodyTypes) {
  EXPECT_EQ(in_words(Condition::kC), "C");
  EXPECT_EQ(in_words(Condition::kDampingForce), "damping+force");
  EXPECT_EQ(in_words(Condition::kIdentification), "the identification (I)");
}

TEST(ConditionsTest, AnUnknownNameIsRefusedInOneLineThatListsThemAll) {
  for (const char* wrong : {"s", "l", "arm-rest", "Signal", "signal+", "", "D"}) {
    const std::string line = refusal("A," + std::string(wrong) + ",B");
    for (const Condition each : conditions_of(kLabConditions)) {
      EXPECT_THAT(line, testing::HasSubstr(name_of(each))) << wrong;
    }
    EXPECT_EQ(std::ranges::count(line, '\n'), 0);
  }
  EXPECT_THAT(refusal("signal,signal"), testing::HasSubstr("signal twice"));
  EXPECT_THAT(refusal("C,force"), testing::HasSubstr("each condition once"));
  EXPECT_THROW(parse_conditions("signal", kStudyConditions), ConfigError);
  for (const char* none : {"P", "I", "J", "C'", "C+"}) {
    EXPECT_THROW(parse_conditions(none), ConfigError) << none;
  }
}

TEST(ConditionsTest, EveryNameIsThatOfOneConditionAndComesBack) {
  // The last enumerator: no row before it is missing or without one.
  ASSERT_STREQ(name_of(Condition::kFreeIdentification), "J");
  std::set<std::string> words;
  for (std::size_t i = 0; i < condition_table().size(); ++i) {
    const ConditionRow& row = condition_table()[i];
    EXPECT_TRUE(words.insert(row.name).second) << row.name;
    EXPECT_EQ(condition_named(row.name), static_cast<Condition>(i));
    if (*row.alias == '\0') continue;
    EXPECT_TRUE(words.insert(row.alias).second) << row.alias;
    EXPECT_EQ(condition_named(row.alias), static_cast<Condition>(i));
  }
  for (const Condition each : conditions_of(kLabConditions)) {
    // The text of the assignment has room for 32.
    EXPECT_LE(std::string_view(name_of(each)).size(), 32u);
  }
  for (const char* none : {"", "a", "s", "free", "Signal"}) EXPECT_FALSE(condition_named(none));
  EXPECT_EQ(title_of(Condition::kCPrime), "C' following");
  EXPECT_EQ(title_of(Condition::kF, " (", ")"), "F (arm rest)");
  EXPECT_EQ(title_of(Condition::kDampingForce), "damping+force");
  EXPECT_EQ(mitigation_name(Condition::kF), "arm-rest");
}

// C' and C+ are C with another model; to a screen or a recording their trials are those of C.
TEST(ConditionsTest, OnlyTheCancellersArePlannedAsC) {
  for (const Condition each : conditions_of(kExperimentConditions)) {
    const bool is_c =
        each == Condition::kC || each == Condition::kCPrime || each == Condition::kCPlus;
    EXPECT_EQ(cancels(each), is_c) << name_of(each);
    EXPECT_EQ(planned_as(each), is_c ? Condition::kC : each) << name_of(each);
  }
  EXPECT_FALSE(cancels(Condition::kP));
}

// apps/study/RESULTS.md, "Chosen"; a schedule has the person's own arms.
TEST(ConditionsTest, AMitigationHasTheNumbersThatTheStudyChose) {
  using Values = std::vector<double>;
  const std::pair<Condition, Values> chosen[]{{Condition::kLowPass, {0.7, 0.7}},
                                              {Condition::kNotch, {1.2, 1.0}},
                                              {Condition::kLmsSignal, {0.01}},
                                              {Condition::kDamping, {0.0, 90.0, 0.0}},
                                              {Condition::kImpedance, {200.0, 60.0, 0.0}}};
  for (const auto& [condition, values] : chosen) {
    EXPECT_EQ(row_of(condition).parts.at(0).values, values) << name_of(condition);
  }
  EXPECT_EQ(row_of(Condition::kLmsForce).parts.at(0).values.at(0), 0.01);
  EXPECT_EQ(row_of(Condition::kDampingForce).parts.at(1), row_of(Condition::kDamping).parts.at(0));
  ProtocolOptions options;
  options.arms = {1.0, 2.0};
  EXPECT_EQ(tracking_trial(options, Condition::kScheduled, 1).parts.at(0).values, options.arms);
  for (std::size_t i = 0; i < condition_table().size(); ++i) {
    const std::string name = condition_table()[i].name;
    EXPECT_EQ(condition_table()[i].arm_rest, name == "F" || name == "arm-rest+force") << name;
  }
}

// The canceller's process makes each of them of what a session identifies.
TEST(ConditionsTest, EachIsMadeOfASessionsModels) {
  const signal::DifferenceModel position{1000.0, {-0.002}, {1.0}};
  ProtocolOptions options;
  const admittance::ArmValues arm = admittance::mean_arm();
  options.arms.assign(arm.begin(), arm.end());
  options.arms.insert(options.arms.end(), arm.begin(), arm.end());
  for (const Condition each : conditions_of(kLabConditions)) {
    const PlannedTrial trial = tracking_trial(options, each, 1);
    EXPECT_EQ(trial.parts.empty(), !is_mitigation(each)) << name_of(each);
    if (trial.parts.empty()) continue;
    EXPECT_NO_THROW(cancellation::PartList(recipe_of(trial.parts, position, {}))) << name_of(each);
  }
}

TEST(ConditionsTest, SignalAsksForATrialWithTheStickFree) {
  const auto trials = planned("B,signal");
  ASSERT_EQ(trials.size(), 4u);
  EXPECT_EQ(trials[0].label, Condition::kIdentification);
  EXPECT_EQ(trials[1].label, Condition::kFreeIdentification);
  EXPECT_EQ(trials[1].trial.phase, TrialPhase::kFree);
  EXPECT_EQ(trials[1].trial.number, 1);
  EXPECT_TRUE(trials[1].moving);
  EXPECT_NE(trials[1].motion_seed, trials[0].motion_seed);
  EXPECT_EQ(planned("B,damping").size(), 3u);
}

TEST(ConditionsTest, AMitigatedTrialCarriesItsPartsAndDoesNotPassForC) {
  const auto trials = planned("B,C,damping");
  for (const PlannedTrial& trial : trials) {
    const bool mitigated = trial.label == Condition::kDamping;
    EXPECT_EQ(trial.cancellation, trial.label == Condition::kC);
    EXPECT_EQ(trial.parts,
              mitigated ? row_of(trial.label).parts : std::vector<cancellation::Part>{});
  }
}

}  // namespace
}  // namespace stillhand::session::conditions_test
