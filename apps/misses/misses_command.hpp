// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::misses {

/// Adds the verb `misses`.
/// @param status  is set to its exit status: 0, also when somebody was late
void add_misses_command(command_line::Command& cli, int& status);

}  // namespace stillhand::misses
