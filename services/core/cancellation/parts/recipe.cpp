// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/parts/recipe.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <string>

#include "services/core/admittance/arm_fit.hpp"
#include "services/core/cancellation/model_check.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"

namespace stillhand::cancellation {
namespace {

constexpr std::size_t kArmValues = admittance::kArmParameters;

[[noreturn]] void refuse(const Part& part, const std::string& want) {
  throw ConfigError(key_of(part), std::to_string(part.values.size()) + " values", want);
}

void require(const Part& part, std::size_t count) {
  if (part.values.size() != count) refuse(part, std::to_string(count));
  if (!std::ranges::all_of(part.values, [](double value) { return std::isfinite(value); })) {
    throw ConfigError(key_of(part), "a value that is not finite", "finite values");
  }
}

// A fit leaves a value that the data do not determine far from everybody's, so the bounds are wide:
// a thousand times the mean person, in the reflex a thousand times the arm's own.
double most_of(std::size_t parameter) {
  constexpr double kFactor = 1000.0;
  constexpr double kMostDelay_s = 1.0;
  const admittance::ArmValues mean = admittance::mean_arm();
  switch (parameter) {
    case admittance::kReflexStiffness:
      return kFactor * mean[admittance::kArmStiffness];
    case admittance::kReflexDamping:
      return kFactor * mean[admittance::kArmDamping];
    case admittance::kReflexDelay:
      return kMostDelay_s;
    default:
      return kFactor * mean[parameter];
  }
}

void require_arm(const Part& part, const admittance::ArmValues& arm) {
  for (std::size_t i = 0; i < kArmValues; ++i) {
    const double most = most_of(i);
    if (std::abs(arm[i]) <= most) continue;
    std::ostringstream got;
    std::ostringstream want;
    got << admittance::arm_parameter_names()[i].name << " = " << arm[i];
    want << "a magnitude of at most " << most;
    throw ConfigError(key_of(part), got.str(), want.str());
  }
}

void add_force(const Part& part, Recipe& recipe) {
  recipe.force = true;
  if (part.values.empty()) return;
  require(part, 4);
  recipe.follow =
      sound_hand(part, {part.values[0], part.values[1], part.values[2], part.values[3]});
}

void add_schedule(const Part& part, Recipe& recipe) {
  require(part, 2 * kArmValues);
  ScheduleConfig schedule;
  std::copy_n(part.values.begin(), kArmValues, schedule.relaxed.begin());
  std::copy_n(part.values.begin() + kArmValues, kArmValues, schedule.holding.begin());
  require_arm(part, schedule.relaxed);
  require_arm(part, schedule.holding);
  recipe.schedule = schedule;
}

// The checks of CC-4, with a bound in metres: 1 m/s^2 moves a free stick to its stop at most.  The
// tracking motion has an RMS of 1.6 m/s^2 (paper III-C): with a larger gain the stick would have
// been at its stop for most of the trial that identified it.
void require_position(const signal::DifferenceModel& model, double lever_m) {
  constexpr auto kTheta = static_cast<std::size_t>(Channel::kTheta);
  const double most_m = lever_m * kChannelFacts[kTheta].full_scale;
  const Refusal why =
      check_model(control_model(model), {.max_gain_n_s2_m = most_m, .max_path_force_n = 1.0})
          .refusal;
  if (why == Refusal::kNone) return;
  std::ostringstream want;
  want << "a stable one at 1000 Hz, of at most " << most_m << " m per m/s^2 at any frequency";
  throw ConfigError("mitigation.signal", std::string(describe(why)), want.str());
}

void add_signal(const Part& part, const std::optional<signal::DifferenceModel>& position,
                Recipe& recipe) {
  require(part, 0);
  if (!position) {
    throw ConfigError("mitigation.signal", "no model", "a model of the feedthrough to position");
  }
  require_position(*position, recipe.lever_m);
  recipe.signal = SignalConfig{*position, {}, {}};
}

void add(const Part& part, const std::optional<signal::DifferenceModel>& position, Recipe& recipe) {
  const PartRow* const row = row_of(part.kind);
  if (row == nullptr) {
    throw ConfigError("mitigation.part", "kind " + std::to_string(static_cast<int>(part.kind)),
                      "a kind that this version of the canceller knows");
  }
  if (part.kind == PartKind::kForce) return add_force(part, recipe);
  if (part.kind == PartKind::kSchedule) return add_schedule(part, recipe);
  if (part.kind == PartKind::kSignal) return add_signal(part, position, recipe);
  require(part, row->values);
  recipe.parts.push_back(part);
}

// Parts that would overwrite each other in a recipe have one; so do all filters of the command.
PartKind place_of(PartKind kind) {
  const PartRow* const row = row_of(kind);
  if (row == nullptr) return kind;
  return row->filters_command ? PartKind::kLowPass : row->in_place_of.value_or(kind);
}

}  // namespace

Recipe recipe_of(const std::vector<Part>& parts,
                 const std::optional<signal::DifferenceModel>& position, const Config& config) {
  if (parts.empty()) throw ConfigError("mitigation", "no part", "at least one part");
  Recipe recipe;
  std::set<PartKind> places;
  for (const Part& part : parts) {
    if (!places.insert(place_of(part.kind)).second) {
      throw ConfigError("mitigation", "two parts of one place", "each part once");
    }
    add(part, position, recipe);
  }
  if (recipe.follow && config.sampling.model_ticks > 1) {
    throw ConfigError(
        "mitigation.force",
        "gain and phase followed at " + std::to_string(config.sampling.model_rate_hz()) + " Hz",
        "a model at 1000 Hz (CC-14)");
  }
  return recipe;
}

}  // namespace stillhand::cancellation
