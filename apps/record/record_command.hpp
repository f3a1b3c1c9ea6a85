// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::record {

/// Adds the verb `record`; `status` is its exit status after parsing.
void add_record_command(command_line::Command& cli, int& status);

}  // namespace stillhand::record
