// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::identify {

/// Adds `stillhand identify`; @param status  its exit status, once it ran
void add_identify_command(command_line::Command& cli, int& status);

}  // namespace stillhand::identify
