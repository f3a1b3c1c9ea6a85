// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::experiment {

/// Adds the verb "experiment" with new, run, status, exclude and unblind.
void add_experiment_command(command_line::Command& cli, int& status);

}  // namespace stillhand::experiment
