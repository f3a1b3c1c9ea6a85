// SPDX-License-Identifier: Apache-2.0
#include "apps/study/mitigations/cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "services/contract/config_error.hpp"

namespace stillhand::study {
namespace {

using mitigation::Recipe;

namespace recipes {

void add_force(Recipe& recipe, const Ingredients& from) {
  recipe.force = cancellation::control_model(from.models.pegged);
}

void add_signal(Recipe& recipe, const Ingredients& from) {
  recipe.signal = mitigation::SignalConfig{from.models.position, {}, {}};
}

void add_damping(Recipe& recipe, const Ingredients& from) {
  recipe.impedance = mitigation::ImpedanceConfig{.damping_n_s_m = from.chosen.damping_n_s_m};
}

Recipe none(const Ingredients&) { return {}; }

Recipe low_pass(const Ingredients& from) { return {.shaping = from.chosen.low_pass}; }

Recipe notch(const Ingredients& from) { return {.shaping = from.chosen.notch}; }

Recipe model_filter(const Ingredients& from) {
  Recipe out;
  add_force(out, from);
  const cancellation::HandCompliance& hand = from.average_hand;
  out.predicted_signal = cancellation::CommandFilterConfig{hand.mass_kg, hand.damping_n_s_m,
                                                           hand.stiffness_n_m, hand.lever_m};
  return out;
}

Recipe signal_alone(const Ingredients& from) {
  Recipe out;
  add_signal(out, from);
  return out;
}

Recipe lms_signal(const Ingredients& from) {
  return {.lms_signal = mitigation::LmsConfig{from.chosen.lms_signal_step, {}}};
}

Recipe lms_force(const Ingredients& from) {
  const cancellation::HandCompliance& hand = from.average_hand;
  return {.lms_force = mitigation::LmsConfig{
              from.chosen.lms_force_step,
              mitigation::SecondaryPath{hand.mass_kg, hand.damping_n_s_m, hand.stiffness_n_m}}};
}

Recipe force(const Ingredients& from) {
  Recipe out;
  add_force(out, from);
  return out;
}

Recipe adaptive(const Ingredients& from) {
  Recipe out = force(from);
  out.force->adapts = from.average_hand;
  return out;
}

Recipe robust(const Ingredients& from) {
  Recipe out;
  const mitigation::ReducedChoice& chosen = from.chosen.reduced;
  signal::DifferenceModel model = from.models.reduced.at(chosen.order - 1);
  for (double& c : model.numerator) c *= chosen.gain;
  out.force = cancellation::control_model(model);
  return out;
}

Recipe scheduled(const Ingredients& from) {
  return {.schedule = mitigation::ScheduleConfig{from.models.relaxed, from.models.holding, {}}};
}

// Both arms of the schedule are the task's.
Recipe task_force(const Ingredients& from) {
  const admittance::ArmValues& arm =
      from.task == TrialTask::kRelax ? from.models.relaxed : from.models.holding;
  return {.schedule = mitigation::ScheduleConfig{arm, arm, {}}};
}

Recipe damping(const Ingredients& from) {
  Recipe out;
  add_damping(out, from);
  return out;
}

Recipe impedance(const Ingredients& from) { return {.impedance = from.chosen.impedance.impedance}; }

Recipe damping_force(const Ingredients& from) {
  Recipe out = force(from);
  add_damping(out, from);
  return out;
}

Recipe signal_force(const Ingredients& from) {
  Recipe out = force(from);
  add_signal(out, from);
  out.signal->moved_by_motor = from.models.holding;
  return out;
}

}  // namespace recipes
}  // namespace

const std::vector<MitigationKind>& mitigation_kinds() {
  using namespace recipes;
  static const std::vector<MitigationKind> kAll{
      {"none", "nothing", false, false, none},
      {"low-pass", "low-pass on the command", false, false, low_pass},
      {"notch", "notch on the command", false, false, notch},
      {"model-filter", "pegged model and an average hand take the motion off the command (CC-5)",
       true, false, model_filter},
      {"signal", "feedthrough to position, of the free stick, is taken off the command", true,
       false, signal_alone},
      {"lms-signal", "adaptive filter of the acceleration is taken off the command", false, false,
       lms_signal},
      {"force", "motor against the pegged model: the paper's", true, false, force},
      {"adaptive", "the same, gain and phase followed (CC-10)", true, false, adaptive},
      {"scheduled", "motor against a model between relaxed and holding, by least squares on line",
       true, false, scheduled},
      {"task-force", "motor against the model of the very task: what a schedule can reach", true,
       false, task_force},
      {"robust", "motor against a reduced model, order and gain by the worst case", true, false,
       robust},
      {"lms-force", "motor against an adaptive filter of the acceleration (filtered-x)", false,
       false, lms_force},
      {"damping", "motor as a damper", false, false, damping},
      {"impedance", "motor as spring, damper and mass, by the worst case", false, false, impedance},
      {"arm-rest", "rest under the forearm", false, true, none},
      {"signal+force", "both; what the motor moves is taken off too", true, false, signal_force},
      {"damping+force", "both by the motor", true, false, damping_force},
      {"arm-rest+force", "both; the model is that of the arm without the rest", true, true, force}};
  return kAll;
}

std::vector<std::size_t> mitigations_named(const std::string& names) {
  const auto& kinds = mitigation_kinds();
  std::vector<bool> wanted(kinds.size(), names == "all");
  wanted[0] = true;
  std::istringstream words(names == "all" ? "" : names);
  std::vector<std::string> seen;
  for (std::string word; std::getline(words, word, ',');) {
    const auto kind = std::ranges::find(kinds, word, &MitigationKind::name);
    if (kind == kinds.end()) {
      std::vector<std::string> known{"all"};
      for (const MitigationKind& one : kinds) known.emplace_back(one.name);
      throw ConfigError("--mitigations", fmt::format("\"{}\"", word),
                        fmt::format("a list of {}", fmt::join(known, ", ")));
    }
    if (std::ranges::find(seen, word) != seen.end()) {
      throw ConfigError("--mitigations", word + " twice", "each mitigation once");
    }
    seen.push_back(word);
    wanted[static_cast<std::size_t>(kind - kinds.begin())] = true;
  }
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i]) out.push_back(i);
  }
  return out;
}

}  // namespace stillhand::study
