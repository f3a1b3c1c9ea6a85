// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::deploy {

/// Adds the verb `deploy` with its own verbs `generate` and `check`.
/// @param status  exit status of the program, set when the verb ran
void add_deploy_command(command_line::Command& cli, int& status);

}  // namespace stillhand::deploy
