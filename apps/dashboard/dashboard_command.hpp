// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace stillhand::dashboard {

/// Adds the verb `dashboard`; `status` is its exit status after parsing.
void add_dashboard_command(CLI::App& cli, int& status);

}  // namespace stillhand::dashboard
