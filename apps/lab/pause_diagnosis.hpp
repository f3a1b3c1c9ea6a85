// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/lab/lab_options.hpp"
#include "apps/lab/live_trials.hpp"
#include "apps/lab/pause_verdict.hpp"
#include "services/core/cancellation/control_model.hpp"

namespace stillhand::lab {

/// Diagnoses the newest pegged trial of the running session while it rests, METHOD "Closing during
/// the session": in a process of its own, below every process of the session.  It does not throw:
/// what fails, or is late, is why there is no C+.
PauseVerdict diagnose_in_pause(const LabOptions& options, LiveTrials& trials);

/// C+ of that diagnosis, which does not follow the hand: neither what judged it nor C does.
/// @throws ConfigError as control_model()
cancellation::ControlModel diagnosed_model(const LabOptions& options);

}  // namespace stillhand::lab
