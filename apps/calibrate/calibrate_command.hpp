// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::calibrate {

/// Adds the verb `calibrate`.  @param status  gets the exit status
void add_calibrate_command(command_line::Command& cli, int& status);

}  // namespace stillhand::calibrate
