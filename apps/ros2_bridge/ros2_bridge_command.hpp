// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace stillhand::ros2_bridge {

/// Adds the verb `ros2-bridge`.  @param status  set when the verb runs: the exit status
void add_ros2_bridge_command(CLI::App& cli, int& status);

}  // namespace stillhand::ros2_bridge
