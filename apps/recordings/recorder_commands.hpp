// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::recordings {

/// Adds the verbs that look at files: `info`, `verify`, `recover`, `export`; `status` is the exit
/// status after parsing.
void add_file_commands(command_line::Command& cli, int& status);

}  // namespace stillhand::recordings
