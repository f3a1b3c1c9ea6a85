// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "idl/control_loop.h"
#include "idl/session.h"
#include "services/core/contract/trial.hpp"
#include "services/core/vehicle/driven_motion.hpp"

namespace stillhand::vehicle {

/// The stick of a sensed sample, for the tick that it answers.
StickSample from_idl(const stillhand_msgs::Sensed& message) noexcept;

/// True where the stick drives: a tracking trial whose assignment moves the platform.
bool driven(const stillhand_msgs::TrialAssignment& assignment, const Trial& trial) noexcept;

}  // namespace stillhand::vehicle
