// SPDX-License-Identifier: Apache-2.0
#include "apps/study/mitigations/cases.hpp"

#include <algorithm>

#include "apps/libraries/session/protocol.hpp"

namespace stillhand::study {
namespace {

using cancellation::PartKind;
using cancellation::Recipe;

// With the numbers that were chosen, in place of those of the table of conditions, which a session
// has.
cancellation::Part chosen_of(const cancellation::Part& part, const Ingredients& from) {
  const auto& [mass_kg, damping_n_s_m, stiffness_n_m, lever_m] = from.average_hand;
  const Chosen& chosen = from.chosen;
  switch (part.kind) {
    case PartKind::kImpedance: {
      // Without stiffness it is a damper; one of half the table's damping keeps to half.
      if (part.values[0] == 0.0) {
        const double share = part.values[1] / row_of(kDamping).parts.front().values[1];
        return {part.kind, {0.0, share * chosen.damping_n_s_m, part.values[2]}};
      }
      const cancellation::ImpedanceConfig& shaped = chosen.impedance.impedance;
      return {part.kind, {shaped.stiffness_n_m, shaped.damping_n_s_m, shaped.mass_kg}};
    }
    case PartKind::kLmsForce:
      return {part.kind, {chosen.lms_force_step, mass_kg, damping_n_s_m, stiffness_n_m}};
    case PartKind::kPredictedSignal:
      return {part.kind, {mass_kg, damping_n_s_m, stiffness_n_m, lever_m}};
    case PartKind::kLmsSignal:
      return {part.kind, {chosen.lms_signal_step}};
    case PartKind::kLowPass:
      return chosen.low_pass;
    case PartKind::kNotch:
      return chosen.notch;
    default:
      return part;
  }
}

void add(const cancellation::Part& part, const Ingredients& from, Recipe& recipe) {
  switch (part.kind) {
    case PartKind::kForce:
      recipe.force = true;
      if (!part.values.empty()) recipe.follow = from.average_hand;
      return;
    case PartKind::kSchedule:
      recipe.schedule = cancellation::ScheduleConfig{from.models.relaxed, from.models.holding, {}};
      return;
    case PartKind::kSignal:
      recipe.signal = cancellation::SignalConfig{from.models.position, {}, {}};
      return;
    default:
      recipe.parts.push_back(chosen_of(part, from));
  }
}

cancellation::ControlModel reduced_model(const Ingredients& from) {
  const ReducedChoice& chosen = from.chosen.reduced;
  signal::DifferenceModel model = from.models.reduced.at(chosen.order - 1);
  for (double& c : model.numerator) c *= chosen.gain;
  return cancellation::control_model(model);
}

}  // namespace

Recipe recipe_of(Condition condition, const Ingredients& from) {
  const std::vector<cancellation::Part>& parts = row_of(condition).parts;
  Recipe recipe;
  if (needs_force(parts)) recipe.model = cancellation::control_model(from.models.pegged);
  for (const cancellation::Part& part : parts) add(part, from, recipe);
  if (condition == kRobust) recipe.model = reduced_model(from);
  if (condition == kTaskForce) {
    // Both arms of the schedule are the task's.
    cancellation::ScheduleConfig& schedule = *recipe.schedule;
    (from.task == TrialTask::kRelax ? schedule.holding : schedule.relaxed) =
        from.task == TrialTask::kRelax ? schedule.relaxed : schedule.holding;
  }
  if (recipe.signal && recipe.force) recipe.signal->moved_by_motor = from.models.holding;
  return recipe;
}

bool needs_model(Condition condition) {
  const std::vector<cancellation::Part>& parts = row_of(condition).parts;
  return cancellation::needs_force(parts) || cancellation::needs_position(parts) ||
         std::ranges::find(parts, PartKind::kSchedule, &cancellation::Part::kind) != parts.end();
}

std::vector<Condition> mitigations_named(const std::string& names) {
  if (names == "all") return session::conditions_of(session::kMitigations);
  std::vector<Condition> out =
      session::parse_conditions(names, session::kMitigations, "--mitigations");
  if (std::ranges::find(out, kB) == out.end()) out.push_back(kB);
  std::ranges::sort(out);
  return out;
}

}  // namespace stillhand::study
