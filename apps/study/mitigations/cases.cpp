// SPDX-License-Identifier: Apache-2.0
#include "apps/study/mitigations/cases.hpp"

#include <algorithm>

#include "apps/session/protocol.hpp"

namespace stillhand::study {
namespace {

using mitigation::PartKind;
using mitigation::Recipe;

void add(const mitigation::Part& part, const Ingredients& from, Recipe& recipe) {
  const cancellation::HandCompliance& hand = from.average_hand;
  const Chosen& chosen = from.chosen;
  switch (part.kind) {
    case PartKind::kForce:
      recipe.force = cancellation::control_model(from.models.pegged);
      if (!part.values.empty()) recipe.force->adapts = hand;
      return;
    case PartKind::kSchedule:
      recipe.schedule = mitigation::ScheduleConfig{from.models.relaxed, from.models.holding, {}};
      return;
    case PartKind::kImpedance:
      recipe.impedance = chosen.impedance.impedance;
      // Without stiffness it is a damper.
      if (part.values[0] == 0.0) {
        recipe.impedance = mitigation::ImpedanceConfig{.damping_n_s_m = chosen.damping_n_s_m};
      }
      return;
    case PartKind::kLmsForce:
      recipe.lms_force = mitigation::LmsConfig{
          chosen.lms_force_step,
          mitigation::SecondaryPath{hand.mass_kg, hand.damping_n_s_m, hand.stiffness_n_m}};
      return;
    case PartKind::kSignal:
      recipe.signal = mitigation::SignalConfig{from.models.position, {}, {}};
      return;
    case PartKind::kPredictedSignal:
      recipe.force = cancellation::control_model(from.models.pegged);
      recipe.predicted_signal = hand;
      return;
    case PartKind::kLmsSignal:
      recipe.lms_signal = mitigation::LmsConfig{chosen.lms_signal_step, {}};
      return;
    case PartKind::kLowPass:
      recipe.shaping = chosen.low_pass;
      return;
    case PartKind::kNotch:
      recipe.shaping = chosen.notch;
      return;
  }
}

cancellation::ControlModel reduced_model(const Ingredients& from) {
  const mitigation::ReducedChoice& chosen = from.chosen.reduced;
  signal::DifferenceModel model = from.models.reduced.at(chosen.order - 1);
  for (double& c : model.numerator) c *= chosen.gain;
  return cancellation::control_model(model);
}

}  // namespace

Recipe recipe_of(Condition condition, const Ingredients& from) {
  Recipe recipe;
  for (const mitigation::Part& part : row_of(condition).parts) add(part, from, recipe);
  if (condition == kRobust) recipe.force = reduced_model(from);
  if (condition == kTaskForce) {
    // Both arms of the schedule are the task's.
    mitigation::ScheduleConfig& schedule = *recipe.schedule;
    (from.task == TrialTask::kRelax ? schedule.holding : schedule.relaxed) =
        from.task == TrialTask::kRelax ? schedule.relaxed : schedule.holding;
  }
  if (recipe.signal && recipe.force) recipe.signal->moved_by_motor = from.models.holding;
  return recipe;
}

bool needs_model(Condition condition) {
  const std::vector<mitigation::Part>& parts = row_of(condition).parts;
  return mitigation::needs_force(parts) || mitigation::needs_position(parts) ||
         std::ranges::find(parts, PartKind::kSchedule, &mitigation::Part::kind) != parts.end();
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
