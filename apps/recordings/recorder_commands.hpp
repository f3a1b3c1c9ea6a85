// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace stillhand::recordings {

/// Adds the verbs that look at files: `info`, `verify`, `recover`, `export`; `status` is the exit
/// status after parsing.
void add_file_commands(CLI::App& cli, int& status);

}  // namespace stillhand::recordings
