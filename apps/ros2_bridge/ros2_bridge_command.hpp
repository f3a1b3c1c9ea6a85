// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::ros2_bridge {

/// Adds the verb `ros2-bridge`.  @param status  set when the verb runs: the exit status
void add_ros2_bridge_command(command_line::Command& cli, int& status);

}  // namespace stillhand::ros2_bridge
