// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace stillhand::lab {

/// The verb `lab` on the command line.  @param status  exit status once the command has run
void add_lab_command(CLI::App& cli, int& status);

}  // namespace stillhand::lab
