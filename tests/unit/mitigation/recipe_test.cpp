// SPDX-License-Identifier: Apache-2.0
// What a trial's assignment carries becomes a mitigation, or is refused before the trial begins.
#include "services/core/cancellation/parts/recipe.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <string>

#include "apps/libraries/session/core/conditions.hpp"
#include "services/core/admittance/arm_fit.hpp"
#include "services/core/cancellation/parts/command_filter.hpp"
#include "services/core/cancellation/parts/command_shaping.hpp"
#include "services/core/cancellation/parts/countermeasure.hpp"
#include "services/core/cancellation/parts/lms_filter.hpp"
#include "services/core/cancellation/parts/stick_impedance.hpp"
#include "services/core/contract/config_error.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::cancellation::recipe_test {

using Position = std::optional<signal::DifferenceModel>;
const Position kPosition = signal::DifferenceModel{1000.0, {-0.002}, {1.0}};

Recipe made(const std::vector<Part>& parts) { return recipe_of(parts, kPosition, {}); }

std::string refusal(const std::vector<Part>& parts, const Position& known = kPosition,
                    const Config& config = {}) {
  return support::refusal([&] { const PartList sut(recipe_of(parts, known, config)); });
}

// Moving stick and platform, and f^.
Moment moment(Tick n) {
  static const Trial kTrial{};
  const double phase = 0.01 * static_cast<double>(n);
  return {3.0 * std::sin(phase),
          0.1 * std::cos(phase),
          -std::sin(phase),
          5.0 * std::sin(phase),
          0.0,
          n,
          kTrial};
}

// Each as the class that its values make, at each of many ticks.
TEST(RecipeTest, ValuesStandInTheOrderOfTheTable) {
  const auto impedance = make_impedance({PartKind::kImpedance, {200.0, 60.0, 0.5}});
  StickImpedance of_impedance({.mass_kg = 0.5, .damping_n_s_m = 60.0, .stiffness_n_m = 200.0});
  const auto lms = make_lms_force({PartKind::kLmsForce, {0.02, 1.0, 2.0, 300.0}});
  LmsFilter of_lms({.step = 0.02, .path = SecondaryPath{1.0, 2.0, 300.0}});
  const auto notch = make_shaping({PartKind::kNotch, {1.2, 0.9}});
  CommandShaping of_notch({ShapingConfig::Kind::kNotch, 1.2, 0.9});
  const auto predicted =
      make_predicted_signal({PartKind::kPredictedSignal, {1.0, 2.0, 300.0, 0.2}});
  CommandFilter of_predicted({1.0, 2.0, 300.0, 0.2});
  for (Tick n = 1; n < 2000; ++n) {
    const Moment now = moment(n);
    EXPECT_EQ(impedance->force_n(now), of_impedance.step(now.theta_rad, now.omega_rad_s));
    EXPECT_EQ(lms->force_n(now), -of_lms.output(now.accel_m_s2));
    lms->learn(now.theta_rad, true);
    of_lms.learn(now.theta_rad, true);
    EXPECT_EQ(notch->filtered_rad(now.theta_rad), of_notch.step(now.theta_rad));
    EXPECT_EQ(predicted->moved_m(now, 1.0),
              now.theta_rad - of_predicted.step(now.theta_rad, now.predicted_n));
  }
  EXPECT_NE(of_lms.weights()[0], 0.0);
}

TEST(RecipeTest, PartsOfModelsStandInTheRecipe) {
  const Recipe both = made({{PartKind::kForce}, {PartKind::kImpedance, {200.0, 60.0, 0.5}}});
  EXPECT_TRUE(both.force);
  EXPECT_FALSE(both.follow);
  EXPECT_EQ(both.parts, (std::vector<Part>{{PartKind::kImpedance, {200.0, 60.0, 0.5}}}));
  const Recipe adaptive = made({{PartKind::kForce, {1.0, 2.0, 300.0, 0.1}}});
  ASSERT_TRUE(adaptive.force && adaptive.follow);
  EXPECT_EQ(adaptive.follow->stiffness_n_m, 300.0);
  std::vector<double> arms(2 * admittance::kArmParameters, 0.0);
  arms[admittance::kArmMass] = 1.5;
  arms[admittance::kArmParameters + admittance::kArmMass] = 2.5;
  const Recipe schedule = made({{PartKind::kSchedule, arms}});
  ASSERT_TRUE(schedule.schedule);
  EXPECT_EQ(schedule.schedule->relaxed[admittance::kArmMass], 1.5);
  EXPECT_EQ(schedule.schedule->holding[admittance::kArmMass], 2.5);
}

TEST(RecipeTest, GainAndPhaseAreFollowedAt1kHzAlone) {
  Config settings;
  settings.sampling = sampling_named("paper");
  const Part follow{PartKind::kForce, {1.394, 11.18, 1136.0, 0.10}};
  EXPECT_THAT(refusal({follow}, kPosition, settings), testing::HasSubstr("1000 Hz"));
  EXPECT_EQ(refusal({{PartKind::kForce}}, kPosition, settings), "accepted");
}

TEST(RecipeTest, WhatIsUnsoundIsRefused) {
  using testing::HasSubstr;
  EXPECT_THAT(refusal({}), HasSubstr("at least one part"));
  EXPECT_THAT(refusal({{static_cast<PartKind>(99), {}}}),
              HasSubstr("a kind that this version of the canceller knows"));
  EXPECT_THAT(refusal({{PartKind::kImpedance, {1.0, 2.0}}}), HasSubstr("2 values, want 3"));
  EXPECT_THAT(refusal({{PartKind::kSignal, {1.0}}}), HasSubstr("1 values, want 0"));
  EXPECT_THAT(refusal({{PartKind::kLmsSignal, {std::numeric_limits<double>::quiet_NaN()}}}),
              HasSubstr("finite"));
  EXPECT_THAT(refusal({{PartKind::kLowPass, {1.0, 0.7}}, {PartKind::kNotch, {1.2, 0.7}}}),
              HasSubstr("each part once"));
  EXPECT_THAT(refusal({{PartKind::kForce}, {PartKind::kPredictedSignal, {1.0, 2.0, 300.0, 0.1}}}),
              HasSubstr("each part once"));
  // What the parts themselves refuse.
  EXPECT_NE(refusal({{PartKind::kImpedance, {0.0, -90.0, 0.0}}}), "accepted");
  EXPECT_NE(refusal({{PartKind::kLowPass, {0.0, 0.7}}}), "accepted");
}

// Sound values of each kind: those of the table of conditions, and the arms of a person.
std::vector<Part> sound_parts() {
  std::vector<Part> out;
  for (const session::ConditionRow& row : session::condition_table()) {
    std::ranges::copy(row.parts, std::back_inserter(out));
  }
  std::vector<double> arms;
  for (int arm = 0; arm < 2; ++arm) {
    const admittance::ArmValues mean = admittance::mean_arm();
    arms.insert(arms.end(), mean.begin(), mean.end());
  }
  for (Part& part : out) {
    if (part.kind == PartKind::kSchedule) part.values = arms;
  }
  return out;
}

// Otherwise no test feeds it.
TEST(RecipeTest, EveryKindIsInTheTableOfConditions) {
  const std::vector<Part> parts = sound_parts();
  for (const PartRow& row : kPartRows) {
    EXPECT_NE(std::ranges::find(parts, row.kind, &Part::kind), parts.end())
        << static_cast<int>(row.kind);
  }
}

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const std::vector<double> kAbsurd{kNan, kInf, -kInf,  1e300,  -1e300, 1e150,
                                  1e9,  -1.0, 1e-300, 5e-324, 0.0};

// Refused in one line, or a mitigation whose outputs are bounded.
bool refused_or_bounded(const Part& part, const Position& known = kPosition) {
  try {
    Recipe recipe = recipe_of({part}, known, {});
    recipe.model = control_model({1000.0, {-3.0}, {1.0}});
    Countermeasure sut({}, recipe);
    for (Tick n = 1; n <= 400; ++n) {
      CountermeasureInput input{};
      input.tick = n;
      input.enabled = input.permitted = true;
      input.sensed = {0.0, 7.5, 9.8, 0.0, n % 2 == 0 ? 0.5 : -0.5, 15.0};
      const CountermeasureOutput out = sut.step(input);
      if (!(std::abs(out.force_n) <= signal::ForceLimits{}.max_force_n)) return false;
      if (!std::isfinite(out.command_rad)) return false;
    }
    return true;
  } catch (const ConfigError& error) {
    return std::string(error.what()).find('\n') == std::string::npos;
  }
}

// Whatever stands in an assignment, the process neither aborts nor leaves the bounds: each value
// alone, each two values together, and all at once.  0.1 s.
TEST(RecipeTest, AbsurdValuesAreRefusedOrBounded) {
  for (const Part& sound : sound_parts()) {
    ASSERT_TRUE(refused_or_bounded(sound));
    ASSERT_EQ(refusal({sound}), "accepted");
    for (const double absurd : kAbsurd) {
      Part part = sound;
      std::ranges::fill(part.values, absurd);
      EXPECT_TRUE(refused_or_bounded(part)) << static_cast<int>(part.kind) << " all " << absurd;
      for (std::size_t i = 0; i < sound.values.size(); ++i) {
        part = sound;
        part.values[i] = absurd;
        EXPECT_TRUE(refused_or_bounded(part)) << static_cast<int>(part.kind) << " " << i;
        if (part.kind == PartKind::kSchedule) continue;  // 26 values
        for (std::size_t j = 0; j < i; ++j) {
          for (const double other : kAbsurd) {
            part.values[j] = other;
            EXPECT_TRUE(refused_or_bounded(part)) << static_cast<int>(part.kind) << " " << i << ", "
                                                  << j << ": " << absurd << ", " << other;
          }
          part.values[j] = sound.values[j];
        }
      }
    }
  }
}

// What no part's own check knows: a damping ratio of 0, and arms that are finite and none.
TEST(RecipeTest, AHandOrAnArmOfNoPersonIsRefusedByName) {
  using testing::HasSubstr;
  for (const std::vector<double>& values : {std::vector<double>{0.01, 1e300, 11.18, 1e300},
                                            {0.01, 1.394, 5e-324, 1136.0},
                                            {0.01, 1.394, 0.05, 1136.0},
                                            {0.01, 0.05, 1.0, 1136.0}}) {
    EXPECT_THAT(refusal({{PartKind::kLmsForce, values}}), HasSubstr("0.1 to 10 kg"));
    EXPECT_THAT(refusal({{PartKind::kPredictedSignal, {values[1], values[2], values[3], 0.10}}}),
                HasSubstr("0.1 to 10 kg"));
    EXPECT_THAT(refusal({{PartKind::kForce, {values[1], values[2], values[3], 0.10}}}),
                HasSubstr("0.1 to 10 kg"));
  }
  const std::vector<Part> sound = sound_parts();
  Part arms = *std::ranges::find(sound, PartKind::kSchedule, &Part::kind);
  arms.values[admittance::kArmParameters + admittance::kGripStiffness] = 1e9;
  EXPECT_THAT(refusal({arms}), HasSubstr("grip_stiffness_n_m = 1e+09"));
  // A reflex of any size up to a thousand arms, and of a second at most.
  const admittance::ArmValues mean = admittance::mean_arm();
  using Bound = std::pair<std::size_t, double>;
  for (const auto& [parameter, most] :
       {Bound{admittance::kReflexDelay, 1.0},
        Bound{admittance::kReflexStiffness, 1000.0 * mean[admittance::kArmStiffness]},
        Bound{admittance::kReflexDamping, 1000.0 * mean[admittance::kArmDamping]}}) {
    Part reflex = *std::ranges::find(sound, PartKind::kSchedule, &Part::kind);
    reflex.values[parameter] = 1.01 * most;
    EXPECT_THAT(refusal({reflex}), HasSubstr(admittance::arm_parameter_names()[parameter].name));
    reflex.values[parameter] = 0.99 * most;
    EXPECT_THAT(refusal({reflex}), testing::Not(HasSubstr("a magnitude of at most")));
  }
}

TEST(RecipeTest, AModelOfPositionIsCheckedAndItsGainBounded) {
  using testing::HasSubstr;
  const auto refusal_of = [](const signal::DifferenceModel& position) {
    EXPECT_TRUE(refused_or_bounded({PartKind::kSignal}, position));
    return refusal({{PartKind::kSignal}}, position);
  };
  EXPECT_EQ(refusal_of({1000.0, {-0.059}, {1.0}}), "accepted");
  EXPECT_THAT(refusal_of({1000.0, {-0.061}, {1.0}}), HasSubstr("0.06 m per m/s^2"));
  // 4 mm at 0 Hz, and 0.1 m at a mode of 5 Hz with a damping ratio of 0.02.
  const double w = 2.0 * std::numbers::pi * 5e-3;
  const double r = std::exp(-0.02 * w);
  const double c = 2.0 * r * std::cos(w);
  EXPECT_THAT(refusal_of({1000.0, {-0.004 * (1.0 - c + r * r), 0.0, 0.0}, {1.0, -c, r * r}}),
              HasSubstr("gain is above"));
  EXPECT_THAT(refusal_of({1000.0, {1e300}, {1.0}}), HasSubstr("gain is above"));
  EXPECT_THAT(refusal_of({1000.0, {-0.002, 0.0}, {1.0, -1.0}}), HasSubstr("unit circle"));
  for (const double rate_hz : {0.0, -1000.0, 50.0, kNan, 1e300}) {
    EXPECT_THAT(refusal_of({rate_hz, {-0.002}, {1.0}}), HasSubstr("1000 Hz"));
  }
  EXPECT_NE(refusal_of({1000.0, {kNan}, {1.0}}), "accepted");
  EXPECT_NE(refusal_of({1000.0, {}, {}}), "accepted");
}

TEST(RecipeTest, WithoutItsModelAPartIsRefused) {
  EXPECT_THAT(refusal({{PartKind::kSignal}}, {}), testing::HasSubstr("no model"));
  EXPECT_EQ(refusal({{PartKind::kSignal}}), "accepted");
}

}  // namespace stillhand::cancellation::recipe_test
