// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/core/cancellation/part.hpp"

/// The table of conditions: what is done about feedthrough in a trial.  Command lines, plans,
/// recordings, experiments, results and exports read it; a new condition is a new row.
/// Pure: no clock, no I/O.
namespace stillhand::session {

/// A row of the table, by its place; those behind the last enumerator have none.  A to C are of the
/// paper, section III-C.  D to F, all with the motor off, are the alternatives that its section V
/// proposes to compare with the motor.  The platform moves in all but A.
enum class Condition : std::uint8_t {
  kA,
  kB,
  kC,
  kCPrime,
  kCPlus,
  kD,
  kE,
  kF,
  kLowPass,
  kNotch,
  kModelFilter,
  kSignal,
  kLmsSignal,
  kAdaptive,
  kScheduled,
  kTaskForce,
  kRobust,
  kLmsForce,
  kDamping,
  kImpedance,
  kSignalForce,
  kDampingForce,
  kArmRestForce,
  kP,
  kIdentification,
  kFreeIdentification,
};

/// Of the paper's tables and figures.
inline constexpr std::array kPaperConditions{Condition::kA, Condition::kB, Condition::kC};

/// Which verb runs a condition; flags.
enum Where : unsigned {
  kLabConditions = 1,         ///< `stillhand lab`, over the bus
  kStudyConditions = 2,       ///< `stillhand study`, in one process
  kExperimentConditions = 4,  ///< `stillhand experiment`: nothing of each participant is needed
  kMitigations = 8,           ///< `stillhand study --mitigations`, by alias where there is one
};

/// What runs the parts.
enum class Means : std::uint8_t {
  kNone,           ///< nothing, or the rig itself is another
  kCanceller,      ///< `cancellation` of the trial's assignment
  kCommandFilter,  ///< in one process alone
  kMitigation,     ///< the parts are in the trial's assignment
};

/// One condition.
struct ConditionRow {
  const char* name;   ///< on command lines, in recordings and results; at most 32 bytes
  const char* alias;  ///< in `stillhand study --mitigations`; empty: the name
  const char* title;  ///< a word or two behind a letter; empty: the name says it
  unsigned where;     ///< of Where
  Means means;
  /// With the numbers that the study chose on other people (apps/study/METHOD.md, SU-18, seed
  /// 20261125) and the average hand of CC-5: no trial of a session changes them.  They say which
  /// models it needs.  Those of `scheduled` are the person's own, ProtocolOptions::arms.
  std::vector<cancellation::Part> parts;
  bool arm_rest;        ///< the forearm rests
  const char* meaning;  ///< in exports
};

/// All, in the order of tables and results.
const std::vector<ConditionRow>& condition_table();
/// Those that a verb runs, in the order of the table.
std::vector<Condition> conditions_of(Where where);

const ConditionRow& row_of(Condition condition);
inline const char* name_of(Condition condition) { return row_of(condition).name; }
/// By name or alias.
std::optional<Condition> condition_named(std::string_view word);
/// In `stillhand study --mitigations`: "none", "arm-rest", "damping".
std::string mitigation_name(Condition condition);
/// "A stationary", "damping+force"; or "A (stationary)".
std::string title_of(Condition condition, const char* between = " ", const char* behind = "");

/// In a sentence: "C", "damping+force", "the identification (I)".
std::string in_words(Condition condition);

/// Whether the motor cancels, as in C.
bool cancels(Condition condition);
/// Whether it is a mitigation, which the trial's assignment carries by name and parts.
inline bool is_mitigation(Condition condition) {
  return row_of(condition).means == Means::kMitigation;
}
/// Whether it needs trial J: a part of it reads the feedthrough to position.
inline bool needs_position(Condition condition) {
  return cancellation::needs_position(row_of(condition).parts);
}
/// C' and C+ are C with another model: how a trial is planned and announced.
inline Condition planned_as(Condition condition) {
  return cancels(condition) ? Condition::kC : condition;
}

}  // namespace stillhand::session
