// SPDX-License-Identifier: Apache-2.0
// What a trial's assignment carries becomes a mitigation, or is refused before the trial begins.
#include "services/mitigation/recipe.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "services/admittance/core/arm_fit.hpp"
#include "services/contract/config_error.hpp"

namespace stillhand::mitigation {
namespace {

SessionModels models() {
  return {cancellation::control_model({1000.0, {-3.0}, {1.0}}),
          signal::DifferenceModel{1000.0, {-0.002}, {1.0}}};
}

Recipe made(const std::vector<Part>& parts) { return recipe_of(parts, models(), {}); }

std::string refusal(const std::vector<Part>& parts, const SessionModels& known = models()) {
  try {
    const Mitigation sut(recipe_of(parts, known, {}));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(RecipeTest, ValuesStandInTheOrderOfTheIdl) {
  const Recipe lms = made({{PartKind::kLmsForce, {0.02, 1.0, 2.0, 300.0}}});
  ASSERT_TRUE(lms.lms_force && lms.lms_force->path);
  EXPECT_EQ(lms.lms_force->step, 0.02);
  EXPECT_EQ(lms.lms_force->path->mass_kg, 1.0);
  EXPECT_EQ(lms.lms_force->path->damping_n_s_m, 2.0);
  EXPECT_EQ(lms.lms_force->path->stiffness_n_m, 300.0);
  const Recipe both = made({{PartKind::kForce}, {PartKind::kImpedance, {200.0, 60.0, 0.5}}});
  ASSERT_TRUE(both.force && both.impedance);
  EXPECT_FALSE(both.force->adapts);
  EXPECT_EQ(both.impedance->stiffness_n_m, 200.0);
  EXPECT_EQ(both.impedance->damping_n_s_m, 60.0);
  EXPECT_EQ(both.impedance->mass_kg, 0.5);
  const Recipe adaptive = made({{PartKind::kForce, {1.0, 2.0, 3.0, 0.1}}});
  ASSERT_TRUE(adaptive.force && adaptive.force->adapts);
  EXPECT_EQ(adaptive.force->adapts->stiffness_n_m, 3.0);
  const Recipe notch = made({{PartKind::kNotch, {1.2, 0.9}}});
  ASSERT_TRUE(notch.shaping);
  EXPECT_EQ(notch.shaping->kind, ShapingConfig::Kind::kNotch);
  EXPECT_EQ(notch.shaping->frequency_hz, 1.2);
  EXPECT_EQ(notch.shaping->damping_ratio, 0.9);
  const Recipe filter = made({{PartKind::kPredictedSignal, {1.0, 2.0, 300.0, 0.1}}});
  ASSERT_TRUE(filter.force && filter.predicted_signal);
  EXPECT_EQ(filter.predicted_signal->damping_n_s_m, 2.0);
  std::vector<double> arms(2 * admittance::kArmParameters, 0.0);
  arms[admittance::kArmMass] = 1.5;
  arms[admittance::kArmParameters + admittance::kArmMass] = 2.5;
  const Recipe schedule = made({{PartKind::kSchedule, arms}});
  ASSERT_TRUE(schedule.schedule);
  EXPECT_EQ(schedule.schedule->relaxed[admittance::kArmMass], 1.5);
  EXPECT_EQ(schedule.schedule->holding[admittance::kArmMass], 2.5);
}

TEST(RecipeTest, TheSettingsOfTheProcessBoundTheForce) {
  cancellation::Config settings;
  settings.limits.max_force_n = 7.0;
  EXPECT_EQ(recipe_of({{PartKind::kSignal}}, models(), settings).canceller.limits.max_force_n, 7.0);
}

TEST(RecipeTest, WhatIsUnsoundIsRefused) {
  using testing::HasSubstr;
  EXPECT_THAT(refusal({}), HasSubstr("at least one part"));
  EXPECT_THAT(refusal({{static_cast<PartKind>(99), {}}}), HasSubstr("a kind of idl/session.idl"));
  EXPECT_THAT(refusal({{PartKind::kImpedance, {1.0, 2.0}}}), HasSubstr("2 values, want 3"));
  EXPECT_THAT(refusal({{PartKind::kSignal, {1.0}}}), HasSubstr("1 values, want 0"));
  EXPECT_THAT(refusal({{PartKind::kLmsSignal, {std::numeric_limits<double>::quiet_NaN()}}}),
              HasSubstr("finite"));
  EXPECT_THAT(refusal({{PartKind::kLowPass, {1.0, 0.7}}, {PartKind::kNotch, {1.2, 0.7}}}),
              HasSubstr("each part once"));
  EXPECT_THAT(refusal({{PartKind::kForce}, {PartKind::kPredictedSignal, {1.0, 2.0, 300.0, 0.1}}}),
              HasSubstr("each part once"));
  // What the parts themselves refuse.
  EXPECT_NE(refusal({{PartKind::kImpedance, {0.0, -90.0, 0.0}}}), "no error");
  EXPECT_NE(refusal({{PartKind::kLowPass, {0.0, 0.7}}}), "no error");
}

TEST(RecipeTest, WithoutItsModelAPartIsRefused) {
  SessionModels known = models();
  known.position.reset();
  EXPECT_THAT(refusal({{PartKind::kSignal}}, known), testing::HasSubstr("no model"));
  known = models();
  known.force.reset();
  EXPECT_THAT(refusal({{PartKind::kForce}}, known), testing::HasSubstr("no model"));
  EXPECT_EQ(refusal({{PartKind::kSignal}}, known), "no error");
}

}  // namespace
}  // namespace stillhand::mitigation
