// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "apps/study/mitigations/design.hpp"
#include "apps/study/mitigations/person_models.hpp"
#include "apps/study/subjects/conditions.hpp"
#include "services/core/cancellation/parts/countermeasure.hpp"

/// The cells of the table of mitigations: what is done, in which task, with whose model, in which
/// motion.
namespace stillhand::study {

/// What the person does in a trial.
enum class TrialTask : std::uint8_t { kRelax, kHold, kTrack };
inline constexpr std::array kTrialTasks{TrialTask::kRelax, TrialTask::kHold, TrialTask::kTrack};
inline constexpr std::array<const char*, 3> kTrialTaskNames{"relax", "hold", "track"};

/// How the platform moves.
enum class TrialMotion : std::uint8_t { kBand, kRoad, kRide };
inline constexpr std::array kTrialMotions{TrialMotion::kBand, TrialMotion::kRoad,
                                          TrialMotion::kRide};
inline constexpr std::array<const char*, 3> kTrialMotionNames{"0.7-2 Hz", "road", "ride"};

/// Whose model a mitigation has; kNone: it needs none.
enum class ModelOf : std::uint8_t { kNone, kOwn, kAverage, kOther };
inline constexpr std::array<const char*, 4> kModelOfNames{"none", "own", "average", "other"};

/// Parameters that were chosen on other people, METHOD Eq. SU-18.
struct Chosen {
  cancellation::Part low_pass{cancellation::PartKind::kLowPass, {1.0, 0.7}};
  cancellation::Part notch{cancellation::PartKind::kNotch, {1.0, 0.7}};
  double damping_n_s_m = 0.0;
  ImpedanceChoice impedance;
  ReducedChoice reduced;
  double lms_signal_step = 0.0;
  double lms_force_step = 0.0;
  std::vector<std::string> log;  ///< one line a choice
};

/// What the parts of a mitigation are made of.
struct Ingredients {
  const PersonModels& models;  ///< of the person whose model it is
  const Chosen& chosen;
  cancellation::HandCompliance average_hand;  ///< of the population
  TrialTask task;                             ///< known to `task-force` alone
};

/// A condition as a recipe, its numbers and models from the ingredients.
cancellation::Recipe recipe_of(Condition condition, const Ingredients& from);
bool needs_model(Condition condition);

/// In the order of the table of conditions; B, "none", is always among them.
/// @param names  "all", or a list of names with commas
/// @throws ConfigError for an unknown or repeated name
std::vector<Condition> mitigations_named(const std::string& names);

}  // namespace stillhand::study
