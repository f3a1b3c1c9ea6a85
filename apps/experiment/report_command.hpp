// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace stillhand::experiment {

/// Adds `stillhand experiment report`; parsing sets `status`.
void add_report_command(CLI::App& verb, int& status);

}  // namespace stillhand::experiment
