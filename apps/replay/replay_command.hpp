// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace stillhand::replay {

/// Adds the verb `replay`; `status` is its exit status after parsing.
void add_replay_command(CLI::App& cli, int& status);

}  // namespace stillhand::replay
