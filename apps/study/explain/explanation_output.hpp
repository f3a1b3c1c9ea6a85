// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/libraries/report/page.hpp"
#include "apps/libraries/report/plot/draw.hpp"
#include "apps/libraries/report/staged_folder.hpp"
#include "apps/study/explain/explain.hpp"

namespace stillhand::study {

/// explanation.json; METHOD, "explanation.json".
std::string explanation_json(const Explanation& explanation);

/// Ranking, tables before and after, posteriors.
std::vector<report::Figure> explanation_figures(const Explanation& explanation);

/// report.html
report::Page explanation_page(const Explanation& explanation, const std::string& command_line,
                              const std::vector<report::Drawing>& drawings);

/// The candidates, with the source of each range.
report::Table causes_table(const std::vector<Cause>& causes);

/// Of the spread: its figure, its sections, and the judged cause that is hardest to separate from
/// one.
report::Figure figure_spread(const Spread& spread);
void add_spread(report::Page& page, const Spread& spread, const report::Drawing& drawing);
std::size_t most_alike(const Spread& spread, std::size_t cause);

/// All files together, or none.
void write_explanation(const Explanation& explanation, const std::string& command_line,
                       report::StagedFolder& folder);

/// The ranking and the tables, on standard output.
void print_explanation(const Explanation& explanation);

/// What an experiment could measure, by judged hypothesis: mean and deviation over subjects.
struct Observable {
  std::string name;
  double Observed::* value;
  double scale;  ///< to the unit in the name
};
const std::vector<Observable>& observables();

}  // namespace stillhand::study
