// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::replay {

/// Adds the verb `replay`; `status` is its exit status after parsing.
void add_replay_command(command_line::Command& cli, int& status);

}  // namespace stillhand::replay
