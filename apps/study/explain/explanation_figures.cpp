// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/study/explain/explanation_output.hpp"

namespace stillhand::study {
namespace {

using report::Colour;
using report::Figure;
using report::Kind;
using report::Panel;
using report::Series;

constexpr std::size_t kPairsShown = 8;

// Log evidence over that of no cause, best at the top.
Figure figure_ranking(const Explanation& explanation) {
  std::vector<const Hypothesis*> shown;
  for (std::size_t c = 1; c < explanation.single.size(); ++c) {
    shown.push_back(&explanation.single[c]);
  }
  for (std::size_t i = 0; i < std::min(kPairsShown, explanation.pairs.size()); ++i) {
    shown.push_back(&explanation.pairs[i]);
  }
  std::ranges::stable_sort(shown, std::ranges::less{},
                           [](const Hypothesis* one) { return one->log_evidence; });
  const double nothing = explanation.single.front().log_evidence;
  Panel panel;
  panel.x.label = "log evidence over that of no cause";
  Series single{.label = "one cause", .kind = Kind::kErrorBars, .colour = Colour::kModel};
  Series pairs{.label = "two causes", .kind = Kind::kErrorBars, .colour = Colour::kConditionC};
  for (std::size_t row = 0; row < shown.size(); ++row) {
    const auto at = static_cast<double>(row + 1);
    panel.y.ticks.push_back({at, shown[row]->name});
    Series& series = shown[row]->causes.size() == 1 ? single : pairs;
    series.x.push_back(shown[row]->log_evidence - nothing);
    series.y.push_back(at);
    series.y_low.push_back(at);
    series.y_high.push_back(at);
  }
  single.kind = pairs.kind = Kind::kPoints;
  panel.y.low = 0.3;
  panel.y.high = static_cast<double>(shown.size()) + 0.7;
  panel.series = {single, pairs};
  panel.reference_lines = {{.direction = report::Direction::kVertical,
                            .at = explanation.best().log_evidence - nothing - kTellsApart,
                            .label = "20 times less probable than the best",
                            .colour = Colour::kNeutral}};
  return {.name = "explain_ranking",
          .caption =
              "Evidence of each cause, parameters integrated out. Left of the line a cause "
              "is 20 times less probable than the best, if all were equally probable "
              "before.",
          .panels = {panel},
          .columns = 1,
          .width_px = 860,
          .height_px = 40 + 24 * static_cast<int>(shown.size())};
}

// The six figures of C, in the paper's standard errors; bars: spread of such tables of twelve.
Figure figure_tables(const Explanation& explanation) {
  const std::array<Colour, 4> colours{Colour::kConditionB, Colour::kWarning, Colour::kModel,
                                      Colour::kConditionC};
  std::vector<const Judged*> shown{&explanation.judged[0], &explanation.judged[1]};
  if (explanation.judged_singles > 2) shown.push_back(&explanation.judged[2]);
  if (explanation.judged.size() > explanation.judged_singles) {
    shown.push_back(&explanation.judged[explanation.judged_singles]);
  }
  Panel panel;
  panel.y.label = "simulated − paper [the paper's standard errors]";
  const std::array<Eigen::Index, 6> rows{6, 7, 8, 12, 13, 14};
  const std::array<const char*, 6> names{"B-C RMS", "B-C dwell", "B-C f_c",
                                         "SD RMS",  "SD dwell",  "SD f_c"};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    panel.x.ticks.push_back({static_cast<double>(i + 1), names[i]});
  }
  for (std::size_t h = 0; h < shown.size(); ++h) {
    Series series{.label = shown[h]->name, .kind = Kind::kErrorBars, .colour = colours[h]};
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Eigen::Index row = rows[i];
      const double z = shown[h]->z[row];
      const double spread =
          std::sqrt(shown[h]->tables.sampling(row, row)) / explanation.paper.standard_error[row];
      series.x.push_back(static_cast<double>(i + 1) + 0.16 * (static_cast<double>(h) - 1.5));
      series.y.push_back(z);
      series.y_low.push_back(z - 2.0 * spread);
      series.y_high.push_back(z + 2.0 * spread);
    }
    panel.series.push_back(series);
  }
  panel.x.low = 0.4;
  panel.x.high = 6.6;
  panel.reference_lines = {{.at = 2.0, .colour = Colour::kNeutral},
                           {.at = 0.0, .label = "paper", .colour = Colour::kTarget},
                           {.at = -2.0, .colour = Colour::kNeutral}};
  return {.name = "explain_tables",
          .caption =
              "What C lacks, before and after. Points: simulated subjects that the "
              "inference did not see. Bars: 95 % of tables of twelve such subjects. SD: "
              "logarithm of the standard deviation between subjects.",
          .panels = {panel},
          .columns = 1,
          .width_px = 860,
          .height_px = 440};
}

}  // namespace

std::vector<Figure> explanation_figures(const Explanation& explanation) {
  std::vector<Figure> out;
  if (!explanation.single.empty()) out = {figure_ranking(explanation), figure_tables(explanation)};
  if (explanation.spread) out.push_back(figure_spread(*explanation.spread));
  return out;
}

}  // namespace stillhand::study
