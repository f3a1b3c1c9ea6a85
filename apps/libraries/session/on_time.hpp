// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "apps/libraries/session/force_budget.hpp"
#include "apps/libraries/session/protocol.hpp"
#include "apps/libraries/session/session_recording.hpp"
#include "services/core/cancellation/config.hpp"
#include "services/core/rig/body_config.hpp"
#include "services/core/rig/motor.hpp"
#include "services/core/sensing/conditioner.hpp"

namespace stillhand::session {

/// Settings of what lies between a raw sample and the motor's force.
struct AnswerConfigs {
  sensing::Config sensing;
  cancellation::Config cancellation;
  rig::MotorConfig motor;
  double lever_m = rig::StickConfig{}.lever_m;  ///< hand to pivot
};

/// Runs the raw samples of a trial with cancellation through conditioner, canceller and motor once
/// more, each in its tick, README Eq. SN-9: what the motor would have done had nothing been late.
/// @param model  number of the model, as the motor commands name it
/// @returns what force_budget() reads; it gives nothing for a model that the recording lacks
BudgetSignals on_time_signals(const SessionRecording& session, const PlannedTrial& planned,
                              std::int32_t model, const AnswerConfigs& configs);

}  // namespace stillhand::session
