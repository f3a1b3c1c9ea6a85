// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::experiment {

/// Adds `stillhand experiment report`; parsing sets `status`.
void add_report_command(command_line::Command& verb, int& status);

}  // namespace stillhand::experiment
