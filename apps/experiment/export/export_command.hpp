// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::experiment {

/// Adds `stillhand experiment export`.
void add_export_command(command_line::Command& verb);

}  // namespace stillhand::experiment
