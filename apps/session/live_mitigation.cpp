// SPDX-License-Identifier: Apache-2.0
#include "apps/session/live_mitigation.hpp"

#include <algorithm>

#include "services/cancellation/core/command_filter.hpp"
#include "services/mitigation/core/lms_filter.hpp"

namespace stillhand::session {
namespace {

using mitigation::Part;
using mitigation::PartKind;

// SU-18, apps/study/RESULTS.md "Chosen".
constexpr double kLowPass_hz = 0.7;
constexpr double kLowPassDamping = 0.7;
constexpr double kNotch_hz = 1.2;
constexpr double kNotchDamping = 1.0;
constexpr double kDamping_n_s_m = 90.0;
constexpr double kShapedStiffness_n_m = 200.0;
constexpr double kShapedDamping_n_s_m = 60.0;
constexpr double kStep = 0.01;  // of both LMS

Part hand(PartKind kind) {
  const cancellation::CommandFilterConfig average;
  return {kind, {average.mass_kg, average.damping_n_s_m, average.stiffness_n_m, average.lever_m}};
}

Part damper(double damping_n_s_m) { return {PartKind::kImpedance, {0.0, damping_n_s_m, 0.0}}; }

Part lms_force() {
  const mitigation::SecondaryPath average;
  return {PartKind::kLmsForce,
          {kStep, average.mass_kg, average.damping_n_s_m, average.stiffness_n_m}};
}

}  // namespace

const std::vector<LiveMitigation>& live_mitigations() {
  static const std::vector<LiveMitigation> kAll{
      {Condition::kLowPass, "low-pass", {{PartKind::kLowPass, {kLowPass_hz, kLowPassDamping}}}},
      {Condition::kNotch, "notch", {{PartKind::kNotch, {kNotch_hz, kNotchDamping}}}},
      {Condition::kModelFilter, "model-filter", {hand(PartKind::kPredictedSignal)}},
      {Condition::kSignal, "signal", {{PartKind::kSignal}}},
      {Condition::kLmsSignal, "lms-signal", {{PartKind::kLmsSignal, {kStep}}}},
      {Condition::kAdaptive, "adaptive", {hand(PartKind::kForce)}},
      {Condition::kScheduled, "scheduled", {{PartKind::kSchedule}}},
      {Condition::kLmsForce, "lms-force", {lms_force()}},
      {Condition::kDamping, "damping", {damper(kDamping_n_s_m)}},
      {Condition::kImpedance,
       "impedance",
       {{PartKind::kImpedance, {kShapedStiffness_n_m, kShapedDamping_n_s_m, 0.0}}}},
      {Condition::kDampingForce, "damping+force", {{PartKind::kForce}, damper(kDamping_n_s_m)}}};
  return kAll;
}

const LiveMitigation* live_mitigation(Condition condition) {
  const auto found = std::ranges::find(live_mitigations(), condition, &LiveMitigation::condition);
  return found == live_mitigations().end() ? nullptr : &*found;
}

bool needs_position(Condition condition) {
  const LiveMitigation* const mitigated = live_mitigation(condition);
  return mitigated != nullptr && mitigation::needs_position(mitigated->parts);
}

std::string condition_label(char label) {
  const LiveMitigation* const mitigated = live_mitigation(static_cast<Condition>(label));
  return mitigated == nullptr ? std::string(1, label) : mitigated->name;
}

char letter_of(std::string_view mitigation) {
  const auto found = std::ranges::find(live_mitigations(), mitigation, &LiveMitigation::name);
  return found == live_mitigations().end() ? '\0' : static_cast<char>(found->condition);
}

}  // namespace stillhand::session
