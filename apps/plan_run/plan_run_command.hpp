// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::plan_run {

/// Adds the verb `plan-run`; `status` is its exit status after parsing.
void add_plan_run_command(command_line::Command& cli, int& status);

}  // namespace stillhand::plan_run
