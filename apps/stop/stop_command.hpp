// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::stop {

/// Adds the verb `stop` to the command line; its callback sets the exit status.
void add_stop_command(command_line::Command& cli, int& status);

}  // namespace stillhand::stop
