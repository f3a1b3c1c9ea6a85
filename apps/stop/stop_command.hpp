// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace stillhand::stop {

/// Adds the verb `stop` to the command line; its callback sets the exit status.
void add_stop_command(CLI::App& cli, int& status);

}  // namespace stillhand::stop
