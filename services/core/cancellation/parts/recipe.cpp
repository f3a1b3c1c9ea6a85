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

std::string key_of(const Part& part) {
  return "mitigation.part " + std::to_string(static_cast<int>(part.kind));
}

[[noreturn]] void refuse(const Part& part, const std::string& want) {
  throw ConfigError(key_of(part), std::to_string(part.values.size()) + " values", want);
}

void require(const Part& part, std::size_t count) {
  if (part.values.size() != count) refuse(part, std::to_string(count));
  if (!std::ranges::all_of(part.values, [](double value) { return std::isfinite(value); })) {
    throw ConfigError(key_of(part), "a value that is not finite", "finite values");
  }
}

void require_hand(const Part& part, const HandCompliance& hand) {
  if (is_hand(hand)) return;
  std::ostringstream got;
  got << "a hand of " << hand.mass_kg << " kg, " << hand.damping_n_s_m << " N s/m, "
      << hand.stiffness_n_m << " N/m, lever " << hand.lever_m << " m";
  throw ConfigError(key_of(part), got.str(),
                    "0.1 to 10 kg, 0.01 to 1 of critical damping, 50 to 10000 N/m, lever 0.02 to "
                    "0.5 m");
}

HandCompliance hand(const Part& part) {
  const HandCompliance hand{part.values[0], part.values[1], part.values[2], part.values[3]};
  require_hand(part, hand);
  return hand;
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
  recipe.follow = hand(part);
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

void add_lms_force(const Part& part, Recipe& recipe) {
  require(part, 4);
  const SecondaryPath path{part.values[1], part.values[2], part.values[3]};
  require_hand(part, {path.mass_kg, path.damping_n_s_m, path.stiffness_n_m, recipe.lever_m});
  recipe.lms_force = LmsConfig{part.values[0], path};
}

void add(const Part& part, const std::optional<signal::DifferenceModel>& position, Recipe& recipe) {
  const std::vector<double>& values = part.values;
  switch (part.kind) {
    case PartKind::kForce:
      return add_force(part, recipe);
    case PartKind::kSchedule:
      return add_schedule(part, recipe);
    case PartKind::kImpedance:
      require(part, 3);
      recipe.impedance = ImpedanceConfig{
          .mass_kg = values[2], .damping_n_s_m = values[1], .stiffness_n_m = values[0]};
      return;
    case PartKind::kLmsForce:
      return add_lms_force(part, recipe);
    case PartKind::kSignal:
      return add_signal(part, position, recipe);
    case PartKind::kPredictedSignal:
      require(part, 4);
      recipe.predicted_signal = hand(part);
      return;
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
  // The motor would take away what CC-5 takes off the command.
  if (kind == PartKind::kPredictedSignal) return static_cast<int>(PartKind::kForce);
  return static_cast<int>(kind);
}

}  // namespace

Recipe recipe_of(const std::vector<Part>& parts,
                 const std::optional<signal::DifferenceModel>& position, const Config& config) {
  if (parts.empty()) throw ConfigError("mitigation", "no part", "at least one part");
  Recipe recipe;
  std::set<int> places;
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
