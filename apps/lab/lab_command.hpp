// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::lab {

/// The verb `lab` on the command line.  @param status  exit status once the command has run
void add_lab_command(command_line::Command& cli, int& status);

}  // namespace stillhand::lab
