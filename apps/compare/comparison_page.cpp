// SPDX-License-Identifier: Apache-2.0
#include "apps/compare/comparison_page.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "apps/compare/findings.hpp"
#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/report/page.hpp"
#include "apps/libraries/report/plot/draw.hpp"
#include "apps/libraries/report/provenance.hpp"
#include "apps/libraries/session/core/conditions.hpp"

namespace stillhand::compare {
namespace {

std::string interval_text(double low, double high) {
  return fmt::format(" ({:.3g} to {:.3g})", low, high);
}

// The palette begins with the conditions' own colours, in the order of their table.
report::Colour colour_of(const std::string& name) {
  using session::Condition;
  static_assert(static_cast<int>(report::Colour::kConditionF) == static_cast<int>(Condition::kF));
  const auto condition = session::condition_named(name);
  return condition && *condition <= Condition::kF ? static_cast<report::Colour>(*condition)
                                                  : report::Colour::kAccent;
}

// One panel: the share that each option restores, with its interval.
report::Panel restored_panel(const Comparison& all, std::size_t m) {
  report::Panel panel;
  panel.title = kMetrics[m].judged;
  panel.y.label = "restored share [%]";
  panel.x.low = 0.5;
  // The names of the two lines stand in the last sixth, where they hide no option.
  panel.x.high = 1.2 * static_cast<double>(all.options.size()) + 0.5;
  panel.legend = report::Legend::kNone;
  for (std::size_t i = 0; i < all.options.size(); ++i) {
    const double at = static_cast<double>(i) + 1.0;
    panel.x.ticks.push_back({at, fmt::format("{}", i + 1)});
    const Outcome& outcome = all.options[i].outcomes[m];
    if (!outcome.restored.share) continue;
    report::Series series;
    series.colour = colour_of(all.options[i].condition);
    series.x = {at};
    series.y = {100.0 * *outcome.restored.share};
    series.kind = report::Kind::kPoints;
    if (outcome.restored.interval) {
      series.kind = report::Kind::kErrorBars;
      series.y_low = {100.0 * outcome.restored.interval->low};
      series.y_high = {100.0 * outcome.restored.interval->high};
    }
    panel.series.push_back(std::move(series));
  }
  panel.reference_lines = {{report::Direction::kHorizontal, 0.0, "as B"},
                           {report::Direction::kHorizontal, 100.0, "as A"}};
  return panel;
}

report::Figure figure_of(const Comparison& all) {
  report::Figure figure;
  figure.name = "comparison";
  figure.caption =
      "Share of the loss through motion that each option restores, (B − X)/(B − A), with its 95 % "
      "interval (Fieller). Options by number: ";
  for (std::size_t i = 0; i < all.options.size(); ++i) {
    figure.caption += fmt::format("{}{} {}", i == 0 ? "" : "; ", i + 1, name_of(all, i));
  }
  figure.caption += ".";
  figure.columns = static_cast<int>(kMetrics.size());
  for (std::size_t m = 0; m < kMetrics.size(); ++m) {
    figure.panels.push_back(restored_panel(all, m));
  }
  return figure;
}

// A and B of every side: what the options are judged by.
report::Table conditions_table(const Comparison& all, std::size_t m) {
  const Number& metric = kMetrics[m];
  report::Table table;
  table.caption = fmt::format("{}{}: mean with its 95 % interval", metric.judged,
                              metric.unit() == "-" ? "" : fmt::format(" [{}]", metric.unit()));
  table.header = {"option",       "people",           "mean",
                  "restored [%]", "worse off than B", "gain of the worst person"};
  for (const Side& side : all.sides) {
    for (const char* label : {"A", "B"}) {
      const Condition* condition = side.find(label);
      if (condition == nullptr) continue;
      std::vector<double> known;
      for (const double value : condition->values[m]) {
        if (std::isfinite(value)) known.push_back(value);
      }
      if (known.empty()) continue;
      std::string text = number(statistics::mean(known));
      if (known.size() > 1) {
        const auto interval = statistics::mean_interval(known);
        text += interval_text(interval.low, interval.high);
      }
      table.rows.push_back({{side.name + ", " + label, report::Emphasis::kFaint},
                            std::to_string(known.size()),
                            text});
    }
  }
  for (std::size_t i = 0; i < all.options.size(); ++i) {
    const Outcome& outcome = all.options[i].outcomes[m];
    if (outcome.people == 0) continue;
    const bool best = all.rankings[m].best == i;
    std::string mean = number(outcome.mean);
    if (outcome.interval) mean += interval_text(outcome.interval->low, outcome.interval->high);
    std::string restored = outcome.restored.share ? number(100.0 * *outcome.restored.share) : "–";
    if (outcome.restored.interval) {
      restored += interval_text(100.0 * outcome.restored.interval->low,
                                100.0 * outcome.restored.interval->high);
    }
    table.rows.push_back(
        {{name_of(all, i), best ? report::Emphasis::kStrong : report::Emphasis::kNone},
         std::to_string(outcome.people),
         mean,
         restored,
         outcome.harmed ? fmt::format("{} of {}", *outcome.harmed, outcome.compared) : "–",
         outcome.least_gain ? number(*outcome.least_gain) : "–"});
  }
  return table;
}

report::Table contrasts_table(const Comparison& all) {
  report::Table table;
  table.caption = "The best option of each metric against every other one";
  table.header = {"metric", "best", "against", "better by", "95 %", "p, Holm", "people"};
  table.align = {report::Align::kLeft,  report::Align::kLeft,  report::Align::kLeft,
                 report::Align::kRight, report::Align::kRight, report::Align::kRight,
                 report::Align::kLeft};
  for (std::size_t m = 0; m < kMetrics.size(); ++m) {
    for (const Contrast& contrast : all.rankings[m].contrasts) {
      table.rows.push_back(
          {kMetrics[m].judged, name_of(all, *all.rankings[m].best), name_of(all, contrast.other),
           number(contrast.better_by), fmt::format("{:.3g} to {:.3g}", contrast.low, contrast.high),
           fmt::format("{:.2g}", contrast.p), contrast.same_people ? "the same" : "different"});
    }
  }
  return table;
}

}  // namespace

void write_report(const Comparison& all, const std::filesystem::path& folder) {
  const report::Figure figure = figure_of(all);
  const auto drawings = report::render({{figure}}, folder);
  report::Page page(
      "Comparison",
      "Which condition is best for which metric, whom it harms, and how sure that is.");
  page.facts({{"made by", report::made_by()}, {"command", report::command_line()}});
  page.list(findings(all));
  page.figure(drawings.front());
  page.table(options_table(all));
  for (std::size_t m = 0; m < kMetrics.size(); ++m) page.table(conditions_table(all, m));
  page.section("How sure");
  page.paragraph(
      "Paired t-test where two options have the same people in the same rides (at least half of "
      "the values of A are the same, bit for bit), Welch's test otherwise; p after Holm over the "
      "contrasts of a metric. A simulated population and an average both say nothing about one "
      "person.");
  page.table(contrasts_table(all));
  page.write(folder / "comparison.html");
}

}  // namespace stillhand::compare
