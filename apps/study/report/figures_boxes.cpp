// SPDX-License-Identifier: Apache-2.0
// Box plots of the metrics, and the wrong models.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "apps/study/report/figures.hpp"
#include "apps/study/report/report_cells.hpp"

namespace stillhand::study {

using report::Colour;
using report::Kind;
using report::Panel;
using report::Series;

namespace {

/// Each subject, next to the box at `place`.
Series subjects_at(double place, Condition condition, const std::vector<double>& values) {
  Series points{.kind = Kind::kPoints,
                .colour = colour_of(condition),
                .point_size = 0.7,
                .show_in_legend = false};
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    points.x.push_back(place + 0.4);
    points.y.push_back(value);
  }
  return points;
}

}  // namespace

report::Figure figure_box(const StudyRecord& record, std::size_t metric) {
  constexpr std::array<const char*, kMetricCount> kNames{"fig10_rms_error", "fig11_dwell_ratio",
                                                         "fig13_crossover"};
  constexpr std::array<const char*, kMetricCount> kNumbers{"Fig. 10", "Fig. 11", "Fig. 13"};
  const session::Number& what = session::kMetrics[metric];
  Panel panel;
  panel.y.label = what.title;
  panel.y.low = 0.0;
  Series paper{.label = "paper, mean", .kind = Kind::kPoints, .colour = Colour::kTarget};
  double place = 1.0;
  for (const auto& [condition, metrics] : record.analysis.conditions) {
    const statistics::BoxPlot& box = metrics[metric].box;
    Series series{.kind = Kind::kBox, .colour = colour_of(condition)};
    // The whiskers cover the whole range, as in the paper.
    series.boxes = {
        {place, box.minimum, box.lower_quartile, box.median, box.upper_quartile, box.maximum}};
    series.show_in_legend = false;
    // Without a known value the box's zeros are no result.
    if (metrics[metric].known > 0) {
      panel.series.push_back(series);
      panel.series.push_back(subjects_at(place, condition, metrics[metric].per_subject));
    }
    panel.x.ticks.push_back({place, title_of(condition)});
    if (condition <= kC) {
      paper.x.push_back(place);
      paper.y.push_back(paper_value(metric, condition));
    }
    place += 1.0;
  }
  const bool has_paper = !paper.x.empty();
  if (has_paper) panel.series.push_back(paper);
  panel.x.low = 0.4;
  panel.x.high = place - 0.4;
  return {.name = kNames[metric],
          .caption = fmt::format(
              "The paper's {}: {} of the subjects. The box reaches from quartile to quartile, with "
              "the median; the whiskers cover the whole range. Marks at its right: the subjects.{}",
              kNumbers[metric], what.title,
              !has_paper    ? ""
              : metric == 0 ? " Squares: the paper's means, at 5.5 mm a unit."
                            : " Squares: the paper's means."),
          .panels = {panel},
          .columns = 1,
          .width_px = 760,
          .height_px = 400};
}

report::Figure figure_wrong_models(const StudyRecord& record) {
  Panel panel;
  panel.y.label = "surviving share of the own model's gain [-]";
  panel.x.label = "subjects, worst first";
  for (const auto& [which, wrong] : record.analysis.wrong) {
    Series series{.label = which == 'O' ? "another subject's model" : "mean model of all others",
                  .kind = Kind::kLineAndPoints,
                  .colour = which == 'O' ? Colour::kWarning : Colour::kModel};
    std::copy_if(wrong.surviving_share.begin(), wrong.surviving_share.end(),
                 std::back_inserter(series.y), [](double share) { return std::isfinite(share); });
    std::sort(series.y.begin(), series.y.end());
    for (std::size_t i = 0; i < series.y.size(); ++i) {
      series.x.push_back(static_cast<double>(i + 1));
    }
    panel.series.push_back(series);
  }
  panel.reference_lines = {{.at = 1.0, .label = "own model", .colour = Colour::kNeutral},
                           {.at = 0.0, .label = "no cancellation", .colour = Colour::kNeutral}};
  return {
      .name = "wrong_models",
      .caption =
          "Cancellation with another subject's model: (B − C with that model) / (B − C with the "
          "own model) of the RMS error, at the same motion and target.",
      .panels = {panel},
      .columns = 1,
      .width_px = 860,
      .height_px = 380};
}

}  // namespace stillhand::study
