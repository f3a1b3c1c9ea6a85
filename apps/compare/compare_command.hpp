// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace stillhand::compare {

/// Adds the verb `compare` to the command line; its callback sets the exit status.
void add_compare_command(CLI::App& cli, int& status);

}  // namespace stillhand::compare
