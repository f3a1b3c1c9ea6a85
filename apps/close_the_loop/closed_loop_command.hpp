// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::close_the_loop {

/// Adds the verb `close-the-loop`.  @param status  exit status of the program
void add_closed_loop_command(command_line::Command& cli, int& status);

}  // namespace stillhand::close_the_loop
