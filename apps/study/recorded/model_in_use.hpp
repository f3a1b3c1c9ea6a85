// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/libraries/measurement/session_trials.hpp"
#include "apps/libraries/session/session_recording.hpp"
#include "apps/study/subjects/conditions.hpp"

/// Which model the motor had in a recorded trial, and which one it should have had.  A model counts
/// from the tick that it names itself; the newest one is in force.
namespace stillhand::study {

/// Which of C, C' and C+ a trial with cancellation is (conditions.hpp), by the model in force when
/// it began; of a mitigation its letter, or '?' for one that this program does not know; of any
/// other trial its letter.
std::optional<Condition> condition_in(const session::SessionRecording& recorded,
                                      const measurement::SessionTrial& trial, std::uint32_t rig);

/// Whether a trial of C+ ran the identified model behind a straight line: the diagnosis of its
/// session left nothing to add (experiment, `control_model: diagnosed`).
bool adds_nothing(const session::SessionRecording& recorded, const measurement::SessionTrial& trial,
                  std::uint32_t rig);

/// Why a trial with cancellation was not what its condition says: the motor ran another model than
/// the one in force in more than 1 % of the recorded commands, for example because the canceller
/// had refused it.  A recording without commands is judged by the canceller's last answer before
/// the trial.  A trial with a mitigation is not what it says if more than 1 % of its commands are
/// not the mitigation's.  Empty: the trial is what its condition says.
std::string other_model_in(const session::SessionRecording& recorded,
                           const measurement::SessionTrial& trial, std::uint32_t rig);

}  // namespace stillhand::study
