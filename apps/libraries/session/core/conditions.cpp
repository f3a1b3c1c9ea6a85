// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/core/conditions.hpp"

#include <algorithm>
#include <utility>

#include "services/core/cancellation/control_model.hpp"

namespace stillhand::session {
namespace {

using cancellation::Part;
using cancellation::PartKind;

// SU-18, apps/study/RESULTS.md "Chosen".
constexpr double kLowPass_hz = 0.7;
constexpr double kLowPassDamping = 0.7;
constexpr double kNotch_hz = 1.2;
constexpr double kNotchDamping = 1.0;
constexpr double kDamping_n_s_m = 90.0;
constexpr double kShapedStiffness_n_m = 200.0;
constexpr double kShapedDamping_n_s_m = 60.0;
constexpr double kStep = 0.01;  // of both LMS
constexpr const cancellation::HandCompliance& kHand = cancellation::kAverageHand;

Part hand(PartKind kind) {
  return {kind, {kHand.mass_kg, kHand.damping_n_s_m, kHand.stiffness_n_m, kHand.lever_m}};
}

Part lms_force() {
  return {PartKind::kLmsForce, {kStep, kHand.mass_kg, kHand.damping_n_s_m, kHand.stiffness_n_m}};
}

ConditionRow row(const char* name, const char* alias, const char* title, unsigned where,
                 Means means, std::vector<Part> parts, const char* meaning) {
  return {name, alias, title, where, means, std::move(parts), false, meaning};
}

constexpr unsigned kLive = kLabConditions | kExperimentConditions | kMitigations;

ConditionRow row(const char* name, std::vector<Part> parts, const char* meaning,
                 unsigned where = kLive) {
  return row(name, "", "", where, Means::kMitigation, std::move(parts), meaning);
}

ConditionRow resting(ConditionRow row) {
  row.arm_rest = true;
  return row;
}

constexpr unsigned kAll = kLabConditions | kStudyConditions | kExperimentConditions;
constexpr const char* kTakenOff =
    "platform moves, motor off, what the predicted force moves is taken off the command";

std::vector<ConditionRow> rows() {
  const Part force{PartKind::kForce};
  const Part damper{PartKind::kImpedance, {0.0, kDamping_n_s_m, 0.0}};
  return {
      row("A", "", "stationary", kAll, Means::kNone, {}, "platform still, motor off"),
      row("B", "none", "moving", kAll | kMitigations, Means::kNone, {},
          "platform moves, motor off"),
      row("C", "force", "cancelled", kAll | kMitigations, Means::kCanceller, {force},
          "platform moves, motor cancels by the model of the session's identification"),
      row("C'", "", "following", kExperimentConditions, Means::kCanceller, {hand(PartKind::kForce)},
          "as C, and the model follows an average hand"),
      row("C+", "", "augmented", kExperimentConditions, Means::kCanceller, {force},
          "platform moves, motor cancels by another model, of a file or of the session's "
          "diagnosis; where that finds nothing, C's own"),
      row("D", "", "command filter", kStudyConditions, Means::kCommandFilter,
          {hand(PartKind::kPredictedSignal)}, kTakenOff),
      row("E", "", "damped stick", kStudyConditions, Means::kNone, {},
          "platform moves, motor off, the stick has more damping"),
      resting(row("F", "arm-rest", "arm rest", kStudyConditions | kMitigations, Means::kNone, {},
                  "platform moves, motor off, the forearm rests")),
      row("low-pass", {{PartKind::kLowPass, {kLowPass_hz, kLowPassDamping}}},
          "platform moves, motor off, the command passes a low-pass"),
      row("notch", {{PartKind::kNotch, {kNotch_hz, kNotchDamping}}},
          "platform moves, motor off, the command passes a notch"),
      row("model-filter", {hand(PartKind::kPredictedSignal)}, kTakenOff),
      row("signal", {{PartKind::kSignal}},
          "platform moves, motor off, the identified feedthrough to position is taken off the "
          "command"),
      row("lms-signal", {{PartKind::kLmsSignal, {kStep}}},
          "platform moves, motor off, an LMS filter takes the feedthrough off"),
      row("adaptive", {hand(PartKind::kForce)},
          "as C, and gain and phase of the model follow an average hand"),
      row("scheduled", {{PartKind::kSchedule}},
          "platform moves, motor cancels by a model between relaxed and holding, found on line",
          kLabConditions | kMitigations),
      row("task-force", {{PartKind::kSchedule}},
          "platform moves, motor cancels by the model of the very task: what a schedule can reach",
          kMitigations),
      row("robust", {force}, "as C, with a reduced model, order and gain by the worst case",
          kMitigations),
      row("lms-force", {lms_force()}, "platform moves, the motor cancels by an LMS filter"),
      row("damping", {damper}, "platform moves, the motor adds damping to the stick"),
      row("impedance", {{PartKind::kImpedance, {kShapedStiffness_n_m, kShapedDamping_n_s_m, 0.0}}},
          "platform moves, the motor adds stiffness and damping to the stick"),
      row("signal+force", {force, {PartKind::kSignal}},
          "as C, and what motion and motor move is taken off the command", kMitigations),
      row("damping+force", {force, damper}, "as C, and the motor adds damping to the stick"),
      resting(row("arm-rest+force", {force},
                  "as C, and the forearm rests; the model is that of the arm without the rest",
                  kMitigations)),
      row("P", "", "perturbed trial", 0, Means::kCanceller, {},
          "platform and motor move the hand at once, to identify it"),
      row("I", "", "identification", 0, Means::kNone, {}, "platform moves, the stick is pegged"),
      row("J", "", "free identification", 0, Means::kNone, {},
          "platform moves, the hand holds the free stick still"),
  };
}

}  // namespace

const std::vector<ConditionRow>& condition_table() {
  static const std::vector<ConditionRow> kTable = rows();
  return kTable;
}

std::vector<Condition> conditions_of(Where where) {
  std::vector<Condition> out;
  for (std::size_t i = 0; i < condition_table().size(); ++i) {
    if ((condition_table()[i].where & where) != 0) out.push_back(static_cast<Condition>(i));
  }
  return out;
}

const ConditionRow& row_of(Condition condition) {
  return condition_table().at(static_cast<std::size_t>(condition));
}

std::optional<Condition> condition_named(std::string_view word) {
  const auto found = std::ranges::find_if(condition_table(), [&](const ConditionRow& row) {
    return word == row.name || (!word.empty() && word == row.alias);
  });
  if (found == condition_table().end()) return std::nullopt;
  return static_cast<Condition>(found - condition_table().begin());
}

std::string mitigation_name(Condition condition) {
  const ConditionRow& row = row_of(condition);
  return *row.alias == '\0' ? row.name : row.alias;
}

std::string title_of(Condition condition, const char* between, const char* behind) {
  const std::string title = row_of(condition).title;
  return name_of(condition) + (title.empty() ? "" : between + title + behind);
}

std::string in_words(Condition condition) {
  const ConditionRow& row = row_of(condition);
  return row.where != 0 ? row.name : "the " + std::string(row.title) + " (" + row.name + ")";
}

bool cancels(Condition condition) {
  return row_of(condition).means == Means::kCanceller && condition != Condition::kP;
}

}  // namespace stillhand::session
