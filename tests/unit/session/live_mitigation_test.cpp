// SPDX-License-Identifier: Apache-2.0
// Mitigations as conditions of a session: their names, their trials.
#include "apps/session/live_mitigation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "services/admittance/core/arm_fit.hpp"
#include "services/contract/config_error.hpp"
#include "services/mitigation/recipe.hpp"

namespace stillhand::session {
namespace {

std::vector<Condition> parsed(const std::string& text) {
  return parse_conditions(text, kLabConditions, Named::kMitigationsToo);
}

ProtocolOptions with(const std::string& conditions) {
  ProtocolOptions options;
  options.conditions = parsed(conditions);
  return options;
}

std::string refusal(const std::string& text) {
  try {
    parsed(text);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(LiveMitigationTest, NamesStandNextToLetters) {
  EXPECT_EQ(parsed("A,B,C,signal,damping+force"),
            (std::vector<Condition>{Condition::kStationary, Condition::kMoving,
                                    Condition::kMovingCancelled, Condition::kSignal,
                                    Condition::kDampingForce}));
  EXPECT_EQ(parsed("none,force"),
            (std::vector<Condition>{Condition::kMoving, Condition::kMovingCancelled}));
}

TEST(LiveMitigationTest, AnUnknownNameIsRefusedInOneLineThatListsThemAll) {
  for (const char* wrong : {"s", "l", "arm-rest", "Signal", "signal+", "", "D"}) {
    const std::string line = refusal("A," + std::string(wrong) + ",B");
    for (const LiveMitigation& one : live_mitigations()) {
      EXPECT_THAT(line, testing::HasSubstr(one.name)) << wrong;
    }
    EXPECT_EQ(std::ranges::count(line, '\n'), 0);
  }
  EXPECT_THAT(refusal("signal,signal"), testing::HasSubstr("signal twice"));
  EXPECT_THAT(refusal("C,force"), testing::HasSubstr("each condition once"));
  // Where letters alone are meant, a letter of the program's own is none.
  EXPECT_THROW(parse_conditions("signal"), ConfigError);
  EXPECT_THROW(parse_conditions("s"), ConfigError);
}

TEST(LiveMitigationTest, EveryNameHasALetterOfItsOwnAndComesBack) {
  std::set<char> letters{'A', 'B', 'C', 'D', 'E', 'F', 'P', kIdentification, kFreeIdentification};
  for (const LiveMitigation& one : live_mitigations()) {
    const char letter = static_cast<char>(one.condition);
    EXPECT_TRUE(letters.insert(letter).second) << one.name;
    EXPECT_EQ(letter_of(one.name), letter);
    EXPECT_EQ(condition_label(letter), one.name);
    EXPECT_STREQ(condition_name(one.condition), one.name);
    // The text of the assignment has room for 32.
    EXPECT_LE(std::string(one.name).size(), 32u);
  }
  EXPECT_EQ(condition_label('C'), "C");
  EXPECT_EQ(letter_of("C"), '\0');
}

// The canceller's process makes each of them of what a session identifies.
TEST(LiveMitigationTest, EachIsMadeOfASessionsModels) {
  const mitigation::SessionModels models{cancellation::control_model({1000.0, {-3.0}, {1.0}}),
                                         signal::DifferenceModel{1000.0, {-0.002}, {1.0}}};
  ProtocolOptions options;
  const admittance::ArmValues arm = admittance::mean_arm();
  options.arms.assign(arm.begin(), arm.end());
  options.arms.insert(options.arms.end(), arm.begin(), arm.end());
  for (const LiveMitigation& one : live_mitigations()) {
    const PlannedTrial planned = tracking_trial(options, one.condition, 1);
    EXPECT_NO_THROW(mitigation::Mitigation(recipe_of(planned.parts, models, {}))) << one.name;
  }
}

TEST(LiveMitigationTest, SignalAsksForATrialWithTheStickFree) {
  const auto trials = plan(with("B,signal"));
  ASSERT_EQ(trials.size(), 4u);
  EXPECT_EQ(trials[0].label, kIdentification);
  EXPECT_EQ(trials[1].label, kFreeIdentification);
  EXPECT_EQ(trials[1].trial.phase, TrialPhase::kFree);
  EXPECT_EQ(trials[1].trial.number, 1);
  EXPECT_TRUE(trials[1].moving);
  EXPECT_NE(trials[1].motion_seed, trials[0].motion_seed);
  EXPECT_EQ(plan(with("B,damping")).size(), 3u);
}

TEST(LiveMitigationTest, AMitigatedTrialCarriesItsPartsAndDoesNotPassForC) {
  const auto trials = plan(with("B,C,damping"));
  for (const PlannedTrial& planned : trials) {
    const bool mitigated = planned.label == static_cast<char>(Condition::kDamping);
    EXPECT_EQ(planned.parts.empty(), !mitigated);
    EXPECT_EQ(planned.cancellation, planned.label == 'C');
    if (mitigated) {
      EXPECT_TRUE(planned.moving);
      EXPECT_EQ(planned.parts, live_mitigation(Condition::kDamping)->parts);
    }
  }
}

// Sessions of letters alone keep their order and seeds.
TEST(LiveMitigationTest, LettersAloneArePlannedAsBefore) {
  ProtocolOptions letters;
  letters.conditions = parse_conditions("A,B,C");
  const auto before = plan(letters);
  const auto now = plan(with("A,B,C"));
  ASSERT_EQ(before.size(), now.size());
  for (std::size_t i = 0; i < now.size(); ++i) {
    EXPECT_EQ(before[i].label, now[i].label);
    EXPECT_EQ(before[i].motion_seed, now[i].motion_seed);
  }
}

}  // namespace
}  // namespace stillhand::session
