// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

namespace CLI {
class App;
}

namespace stillhand::study {

struct StudyRecord;

/// Adds --plan and --plan-effect; parsing sets `effects_dz` (StudyRecord::plan_dz).
void add_plan_options(CLI::App& cli, std::optional<std::vector<double>>& effects_dz);

/// Adds --diagnose and --simulated, for recorded people.
void add_people_options(CLI::App& cli, StudyRecord& record);

}  // namespace stillhand::study
