// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::study {

/// Adds the verb "study".  @param status  exit status of the program, set when the verb ran
void add_study_command(command_line::Command& cli, int& status);

}  // namespace stillhand::study
