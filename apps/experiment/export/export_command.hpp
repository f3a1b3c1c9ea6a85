// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace stillhand::experiment {

/// Adds `stillhand experiment export`.
void add_export_command(CLI::App& verb);

}  // namespace stillhand::experiment
