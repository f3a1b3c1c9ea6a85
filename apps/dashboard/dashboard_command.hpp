// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::dashboard {

/// Adds the verb `dashboard`; `status` is its exit status after parsing.
void add_dashboard_command(command_line::Command& cli, int& status);

}  // namespace stillhand::dashboard
