// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace stillhand::experiment {

/// Adds the verb "experiment" with new, run, status, exclude and unblind.
void add_experiment_command(CLI::App& cli, int& status);

}  // namespace stillhand::experiment
