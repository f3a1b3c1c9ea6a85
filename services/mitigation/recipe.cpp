// SPDX-License-Identifier: Apache-2.0
#include "services/mitigation/recipe.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "services/contract/config_error.hpp"

namespace stillhand::mitigation {
namespace {

constexpr std::size_t kArmValues = admittance::kArmParameters;

[[noreturn]] void refuse(const Part& part, const std::string& want) {
  throw ConfigError("mitigation.part " + std::to_string(static_cast<int>(part.kind)),
                    std::to_string(part.values.size()) + " values", want);
}

void require(const Part& part, std::size_t count) {
  if (part.values.size() != count) refuse(part, std::to_string(count));
  if (!std::ranges::all_of(part.values, [](double value) { return std::isfinite(value); })) {
    throw ConfigError("mitigation.part " + std::to_string(static_cast<int>(part.kind)),
                      "a value that is not finite", "finite values");
  }
}

cancellation::HandCompliance hand(const Part& part) {
  return {part.values[0], part.values[1], part.values[2], part.values[3]};
}

cancellation::ControlModel force_of(const SessionModels& models) {
  if (models.force) return *models.force;
  throw ConfigError("mitigation.force", "no model", "a model of the feedthrough force");
}

void add_force(const Part& part, const SessionModels& models, Recipe& recipe) {
  recipe.force = force_of(models);
  if (part.values.empty()) return;
  require(part, 4);
  recipe.force->adapts = hand(part);
}

void add_schedule(const Part& part, Recipe& recipe) {
  require(part, 2 * kArmValues);
  ScheduleConfig schedule;
  std::copy_n(part.values.begin(), kArmValues, schedule.relaxed.begin());
  std::copy_n(part.values.begin() + kArmValues, kArmValues, schedule.holding.begin());
  recipe.schedule = schedule;
}

void add_predicted_signal(const Part& part, const SessionModels& models, Recipe& recipe) {
  require(part, 4);
  recipe.force = force_of(models);
  const cancellation::HandCompliance feels = hand(part);
  recipe.predicted_signal = cancellation::CommandFilterConfig{feels.mass_kg, feels.damping_n_s_m,
                                                              feels.stiffness_n_m, feels.lever_m};
}

void add_signal(const Part& part, const SessionModels& models, Recipe& recipe) {
  require(part, 0);
  if (!models.position) {
    throw ConfigError("mitigation.signal", "no model", "a model of the feedthrough to position");
  }
  recipe.signal = SignalConfig{*models.position, {}, {}};
}

void add(const Part& part, const SessionModels& models, Recipe& recipe) {
  const std::vector<double>& values = part.values;
  switch (part.kind) {
    case PartKind::kForce:
      return add_force(part, models, recipe);
    case PartKind::kSchedule:
      return add_schedule(part, recipe);
    case PartKind::kImpedance:
      require(part, 3);
      recipe.impedance = ImpedanceConfig{
          .mass_kg = values[2], .damping_n_s_m = values[1], .stiffness_n_m = values[0]};
      return;
    case PartKind::kLmsForce:
      require(part, 4);
      recipe.lms_force = LmsConfig{values[0], SecondaryPath{values[1], values[2], values[3]}};
      return;
    case PartKind::kSignal:
      return add_signal(part, models, recipe);
    case PartKind::kPredictedSignal:
      return add_predicted_signal(part, models, recipe);
    case PartKind::kLmsSignal:
      require(part, 1);
      recipe.lms_signal = LmsConfig{values[0], {}};
      return;
    case PartKind::kLowPass:
    case PartKind::kNotch:
      require(part, 2);
      recipe.shaping = ShapingConfig{part.kind == PartKind::kNotch ? ShapingConfig::Kind::kNotch
                                                                   : ShapingConfig::Kind::kLowPass,
                                     values[0], values[1]};
      return;
  }
  refuse(part, "a kind of idl/session.idl");
}

// Parts that would overwrite each other in a recipe.
int place_of(PartKind kind) noexcept {
  if (kind == PartKind::kNotch) return static_cast<int>(PartKind::kLowPass);
  // CC-5 reads the force's prediction, which then drives no motor.
  if (kind == PartKind::kPredictedSignal) return static_cast<int>(PartKind::kForce);
  return static_cast<int>(kind);
}

}  // namespace

Recipe recipe_of(const std::vector<Part>& parts, const SessionModels& models,
                 const cancellation::Config& canceller) {
  if (parts.empty()) throw ConfigError("mitigation", "no part", "at least one part");
  Recipe recipe;
  recipe.canceller = canceller;
  std::set<int> places;
  for (const Part& part : parts) {
    if (!places.insert(place_of(part.kind)).second) {
      throw ConfigError("mitigation", "two parts of one place", "each part once");
    }
    add(part, models, recipe);
  }
  return recipe;
}

}  // namespace stillhand::mitigation
