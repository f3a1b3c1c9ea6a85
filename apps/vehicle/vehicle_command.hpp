// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::vehicle {

/// Adds the verb `vehicle`.  @param status  exit status of the program, once the verb has run
void add_vehicle_command(command_line::Command& cli, int& status);

}  // namespace stillhand::vehicle
