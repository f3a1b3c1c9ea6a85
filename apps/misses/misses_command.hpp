// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace stillhand::misses {

/// Adds the verb `misses`.
/// @param status  is set to its exit status: 0, also when somebody was late
void add_misses_command(CLI::App& cli, int& status);

}  // namespace stillhand::misses
