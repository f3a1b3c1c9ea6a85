// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

namespace stillhand::command_line {
class Command;
}

namespace stillhand::study {

struct StudyRecord;

/// Adds --plan and --plan-effect; parsing sets `effects_dz` (StudyRecord::plan_dz).
void add_plan_options(command_line::Command& cli, std::optional<std::vector<double>>& effects_dz);

/// Adds --diagnose and --simulated, for recorded people.
void add_people_options(command_line::Command& cli, StudyRecord& record);

}  // namespace stillhand::study
