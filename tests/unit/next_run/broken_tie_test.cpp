// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/broken_tie.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "services/core/contract/config_error.hpp"
#include "tests/unit/next_run/two_channels.hpp"

namespace stillhand::diagnose::broken_tie_test {

namespace made = next_run::made;
using testing::HasSubstr;

const next_run::PlanFile kPlan{20.0, "ride.csv", {made::candidate("x"), made::candidate("z")}};

TEST(BrokenTieTest, SaysWhichOneIsLeft) {
  const BrokenTie sut = broken_tie(kPlan, made::measured(3300, 4, 1), made::measured(2100, 8, 2));
  EXPECT_THAT(tie_table(sut), HasSubstr("broken, left is: coupled_input (of x, static)"));
  const auto json = nlohmann::ordered_json::parse(with_tie("{}", sut)).at("tie");
  EXPECT_EQ(json.at("broken"), true);
  EXPECT_EQ(json.at("left").size(), 1U);
  EXPECT_EQ(json.at("evidence").at(0).at("against"), "coupled_input (of z, static)");
}

TEST(BrokenTieTest, ARepetitionLeavesBoth) {
  const BrokenTie sut = broken_tie(kPlan, made::measured(3300, 4, 1), made::measured(2100, 4, 2));
  EXPECT_THAT(tie_table(sut), HasSubstr("left: coupled_input (of x, static) and coupled_input"));
  EXPECT_EQ(nlohmann::ordered_json::parse(with_tie("{}", sut)).at("tie").at("broken"), false);
}

TEST(BrokenTieTest, ARunWithoutAChannelIsRefused) {
  auto run = made::measured(2100, 8, 2);
  run.channels.erase(run.channels.begin() + 2);
  EXPECT_THROW(static_cast<void>(broken_tie(kPlan, made::measured(3300, 4, 1), run)), ConfigError);
}

// They would differ by how much each of them fails.
TEST(BrokenTieTest, ARunThatNoCandidateExplainsBreaksNothing) {
  auto run = made::measured(2100, 8, 2);
  for (double& value : run.channels.back().values) value = -value;
  EXPECT_THROW(static_cast<void>(broken_tie(kPlan, made::measured(3300, 4, 1), run)), ConfigError);
}

TEST(BrokenTieTest, ARunThatWasCutShortBreaksNothing) {
  EXPECT_THROW(
      static_cast<void>(broken_tie(kPlan, made::measured(3300, 4, 1), made::measured(900, 8, 2))),
      ConfigError);
}

TEST(BrokenTieTest, APlanWhoseCandidatesAreNotFiniteIsRefused) {
  next_run::PlanFile plan = kPlan;
  for (auto& candidate : plan.candidates) candidate.model.body.numerators = {{1e200}};
  EXPECT_THROW(
      static_cast<void>(broken_tie(plan, made::measured(3300, 4, 1), made::measured(2100, 8, 2))),
      ConfigError);
}

}  // namespace stillhand::diagnose::broken_tie_test
