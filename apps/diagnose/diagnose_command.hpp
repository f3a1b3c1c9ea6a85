// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace stillhand::diagnose {

/// Adds the verb `diagnose`; `status` is its exit status after parsing.
void add_diagnose_command(CLI::App& cli, int& status);

}  // namespace stillhand::diagnose
