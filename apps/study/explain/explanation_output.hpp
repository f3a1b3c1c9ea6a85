// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/libraries/report/page.hpp"
#include "apps/libraries/report/staged_folder.hpp"
#include "apps/study/explain/explain.hpp"

namespace stillhand::study {

/// explanation.json; METHOD, "explanation.json".
std::string explanation_json(const Explanation& explanation);

/// The candidates, with the source of each range.
report::Table causes_table(const std::vector<Cause>& causes);

/// The sections of the spread.
void add_spread(report::Page& page, const Spread& spread);

/// report.html and explanation.json: both, or none.
void write_explanation(const Explanation& explanation, const std::string& command_line,
                       report::StagedFolder& folder);

/// What an experiment could measure, by judged hypothesis: mean and deviation over subjects.
struct Observable {
  std::string name;
  double Observed::* value;
  double scale;  ///< to the unit in the name
};
const std::vector<Observable>& observables();

}  // namespace stillhand::study
