// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace stillhand::calibrate {

/// Adds the verb `calibrate`.  @param status  gets the exit status
void add_calibrate_command(CLI::App& cli, int& status);

}  // namespace stillhand::calibrate
