// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "idl/control_loop.h"
#include "services/core/rig/rig.hpp"

namespace stillhand::rig {

/// The messages that a step used. With RigTruth, a recording holds all inputs of the step.
struct UsedTicks {
  static constexpr Tick kHeld = -2;
  Tick command = -1;   ///< tick of the platform command, -1 none, kHeld: the platform was held
  Tick motor = -1;     ///< tick answered by the motor command, -1 none
  Tick volition = -1;  ///< tick answered by the operator's force, -1 none
};

stillhand_msgs::RawSample to_idl(const RigOutput& output, Tick tick);
stillhand_msgs::RigTruth to_idl(const RigOutput& output, Tick tick, const RigInput& input,
                                const UsedTicks& used);

/// The input of the step at `tick`, from the messages that it uses; nullptr: no message.
RigInput make_input(Tick tick, const stillhand_msgs::PlatformCommand* command,
                    const stillhand_msgs::MotorCommand* motor,
                    const stillhand_msgs::OperatorForce* volition, bool pegged,
                    bool motor_permitted);

/// Puts the motor's part into an input; nullptr: no command.
void put_motor(RigInput& input, Tick tick, const stillhand_msgs::MotorCommand* motor,
               bool permitted);

}  // namespace stillhand::rig
