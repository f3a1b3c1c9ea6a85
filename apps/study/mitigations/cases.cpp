// SPDX-License-Identifier: Apache-2.0
#include "apps/study/mitigations/cases.hpp"

#include <algorithm>

#include "apps/libraries/session/protocol.hpp"

namespace stillhand::study {
namespace {

using cancellation::PartKind;
using cancellation::Recipe;

void add(const cancellation::Part& part, const Ingredients& from, Recipe& recipe) {
  const cancellation::HandCompliance& hand = from.average_hand;
  const Chosen& chosen = from.chosen;
  switch (part.kind) {
    case PartKind::kForce:
      recipe.force = true;
      if (!part.values.empty()) recipe.follow = hand;
      return;
    case PartKind::kSchedule:
      recipe.schedule = cancellation::ScheduleConfig{from.models.relaxed, from.models.holding, {}};
      return;
    case PartKind::kImpedance:
      recipe.impedance = chosen.impedance.impedance;
      // Without stiffness it is a damper.
      if (part.values[0] == 0.0) {
        recipe.impedance = cancellation::ImpedanceConfig{.damping_n_s_m = chosen.damping_n_s_m};
      }
      return;
    case PartKind::kLmsForce:
      recipe.lms_force = cancellation::LmsConfig{
          chosen.lms_force_step,
          cancellation::SecondaryPath{hand.mass_kg, hand.damping_n_s_m, hand.stiffness_n_m}};
      return;
    case PartKind::kSignal:
      recipe.signal = cancellation::SignalConfig{from.models.position, {}, {}};
      return;
    case PartKind::kPredictedSignal:
      recipe.predicted_signal = hand;
      return;
    case PartKind::kLmsSignal:
      recipe.lms_signal = cancellation::LmsConfig{chosen.lms_signal_step, {}};
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
