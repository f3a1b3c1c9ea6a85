// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::diagnose {

/// Adds the verb `diagnose`; `status` is its exit status after parsing.
void add_diagnose_command(command_line::Command& cli, int& status);

}  // namespace stillhand::diagnose
