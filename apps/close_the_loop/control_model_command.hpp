// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::close_the_loop {

/// Adds the verb `control-model`; `status` is its exit status after parsing.
void add_control_model_command(command_line::Command& cli, int& status);

}  // namespace stillhand::close_the_loop
