// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/libraries/session/in_process.hpp"
#include "apps/study/subjects/subject_session.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/identification/identifier.hpp"

/// From the signals of one trial to its part of a study: the one path for simulated subjects and
/// for recorded participants.
namespace stillhand::study {

/// Ticks between two kept samples of a tracking trial: the paper records at 100 Hz.
inline constexpr Tick kKeepEvery = 10;

/// The model of a pegged trial.
/// @param pegged  acceleration [m/s^2] and force [N] as sensed, at 1 kHz
/// @throws ConfigError when no usable model results
Identification identified(const identification::Record& pegged);

/// The metrics of a tracking trial.
/// @param signals  every kKeepEvery ticks
/// @param planned  its length, and whether the motor cancels
TrackedTrial evaluated(const session::TrialSignals& signals, const session::PlannedTrial& planned);

}  // namespace stillhand::study
