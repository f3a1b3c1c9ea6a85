// SPDX-License-Identifier: Apache-2.0
#include "apps/study/plan_options.hpp"

#include <algorithm>

#include "apps/study/report/output.hpp"
#include "services/files/settings/check_number.hpp"
#include "services/system/command_line/command_line.hpp"

namespace stillhand::study {

void add_plan_options(command_line::Command& cli, std::optional<std::vector<double>>& effects_dz) {
  cli.add_flag_callback(
      "--plan", [&effects_dz] { effects_dz = effects_dz.value_or(std::vector<double>{}); },
      "number of participants that the planned comparisons need for power 0.8 and 0.9, if the "
      "effect is that of these data, or half of it");
  cli.add_option_function<std::vector<double>>(
         "--plan-effect", [&effects_dz](const std::vector<double>& given) { effects_dz = given; },
         "with --plan: further effect sizes d_z (mean difference over its standard deviation)")
      .check(settings::number_between(0.01, 100.0))
      .needs("--plan");
}

void add_people_options(command_line::Command& cli, StudyRecord& record) {
  cli.add_flag("--diagnose", record.diagnose,
               "find what the model lacks in each person, and what C+ would have gained");
  cli.add_flag("--simulated", record.simulate,
               "add simulated subjects: the same ones, with a paired test, if the participants are "
               "simulated; otherwise as many subjects of the population");
}

}  // namespace stillhand::study
