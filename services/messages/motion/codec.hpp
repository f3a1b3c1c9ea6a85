// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "idl/control_loop.h"
#include "idl/session.h"
#include "services/core/contract/trial.hpp"
#include "services/core/motion/motion_profile.hpp"
#include "services/core/motion/platform_command.hpp"

namespace stillhand::motion {

/// @param tick  the tick the command is for
stillhand_msgs::PlatformCommand to_idl(const PlatformCommand& command, Tick tick,
                                       std::int64_t trial);

/// What a trial asks of the platform.  A ride's samples are not on the bus: the process adds them.
MotionProfile from_idl(const stillhand_msgs::TrialAssignment& assignment, const Trial& trial);

}  // namespace stillhand::motion
