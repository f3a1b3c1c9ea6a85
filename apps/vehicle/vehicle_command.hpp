// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace stillhand::vehicle {

/// Adds the verb `vehicle`.  @param status  exit status of the program, once the verb has run
void add_vehicle_command(CLI::App& cli, int& status);

}  // namespace stillhand::vehicle
