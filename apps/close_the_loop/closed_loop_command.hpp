// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace stillhand::close_the_loop {

/// Adds the verb `close-the-loop`.  @param status  exit status of the program
void add_closed_loop_command(CLI::App& cli, int& status);

}  // namespace stillhand::close_the_loop
