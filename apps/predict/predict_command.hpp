// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::command_line {
class Command;
}

namespace stillhand::predict {

/// Adds the verb `predict`; `status` is its exit status after parsing.
void add_predict_command(command_line::Command& cli, int& status);

}  // namespace stillhand::predict
