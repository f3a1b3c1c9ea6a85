// SPDX-License-Identifier: Apache-2.0
// Report: simulated subjects next to recorded people.
#include <fmt/format.h>

#include <algorithm>

#include "apps/libraries/report/text/text.hpp"
#include "apps/study/report/figures.hpp"
#include "apps/study/report/report_cells.hpp"
#include "apps/study/report/report_sections.hpp"

namespace stillhand::study {
namespace {

using report::Cell;
using report::Colour;
using report::Emphasis;
using report::Kind;
using report::number;
using session::kMetrics;

// A change of a metric needs a digit more than the metric itself.
int fine(std::size_t metric) { return decimals(metric) + 1; }

report::Table means_table(const StudyRecord& record) {
  const SimulatedSide& simulated = *record.simulated;
  report::Table table;
  table.caption = fmt::format(
      "{} {} as recorded, {} subjects simulated in one process, and the paper's twelve: mean ± SD.",
      record.results.size(),
      subjects_of(record) == Subjects::kPeople ? "participants" : "simulated subjects",
      simulated.results.size());
  table.header = {"metric", "condition", "recorded", "simulated", "paper"};
  for (std::size_t k = 0; k < kMetricCount; ++k) {
    for (const auto& [condition, metrics] : record.analysis.conditions) {
      const auto made = simulated.analysis.conditions.find(condition);
      table.rows.push_back(
          {kMetrics[k].title, name_of(condition), mean_and_deviation(metrics[k], k),
           made == simulated.analysis.conditions.end() ? std::string("–")
                                                       : mean_and_deviation(made->second[k], k),
           Cell(condition <= kC ? number(paper_value(k, condition), decimals(k)) : "–",
                Emphasis::kFaint)});
    }
    if (!record.analysis.restoration.contains(kC)) continue;
    table.rows.push_back(
        {std::string(kMetrics[k].title) + ", restored by C", "", restored_text(record.analysis, k),
         restored_text(simulated.analysis, k),
         Cell(number(kMetrics[k].paper->restored_percent, 0) + " %", Emphasis::kFaint)});
  }
  return table;
}

report::Table paired_table(const SimulatedSide& simulated) {
  report::Table table;
  table.caption = fmt::format(
      "Recorded minus simulated, person by person. t: paired t-test, p of Holm over all rows; W: "
      "Wilcoxon's signed ranks, two-sided, not adjusted. Strong: below {}.",
      report::short_number(SimulatedSide::kAlpha));
  table.header = {"metric", "condition", "people", "difference [95 % CI]",
                  "p (t)",  "p (Holm)",  "p (W)"};
  std::vector<PairedCheck> checks = simulated.paired;
  std::ranges::stable_sort(checks, {}, &PairedCheck::metric);
  for (const PairedCheck& check : checks) {
    std::vector<Cell> row{kMetrics[check.metric].title, name_of(check.condition),
                          std::to_string(check.n)};
    if (check.test) {
      row.emplace_back(fmt::format("{} [{}, {}]", number(check.mean_difference, fine(check.metric)),
                                   number(check.test->ci_low, fine(check.metric)),
                                   number(check.test->ci_high, fine(check.metric))));
      row.emplace_back(p_value(check.test->p));
      row.emplace_back(p_value(*check.p_holm),
                       *check.p_holm < SimulatedSide::kAlpha ? Emphasis::kStrong : Emphasis::kNone);
    } else {
      row.emplace_back(check.n > 0 ? number(check.mean_difference, fine(check.metric)) : "–");
      row.insert(row.end(), 2, Cell("–"));
    }
    row.emplace_back(check.n > 0 ? p_value(check.p_signed_rank) : std::string("–"));
    table.rows.push_back(row);
  }
  return table;
}

}  // namespace

std::string chance_sentence(const SimulatedSide& simulated) {
  const auto tests = static_cast<std::size_t>(std::ranges::count_if(
      simulated.paired, [](const PairedCheck& check) { return check.test.has_value(); }));
  if (std::ranges::none_of(simulated.paired,
                           [](const PairedCheck& check) { return check.n > 0; })) {
    return "There is no test: no person was both recorded and simulated.";
  }
  const bool equal = std::ranges::all_of(simulated.paired, [](const PairedCheck& check) {
    return check.n == 0 || (check.mean_difference == 0.0 && !check.test);
  });
  if (equal) return "Recorded and simulated people do not differ at all.";
  if (tests == 0) return "There is no test: fewer than two people, or no variance.";
  double smallest = 1.0;
  for (const PairedCheck& check : simulated.paired) {
    smallest = std::min(smallest, check.p_holm.value_or(1.0));
  }
  const std::size_t more = simulated.more_than_chance();
  if (more == 0) {
    return fmt::format(
        "Recorded and simulated people differ by no more than chance: the smallest p of {} paired "
        "t-tests is {} after Holm, not below {}.",
        tests, p_value(smallest), report::short_number(SimulatedSide::kAlpha));
  }
  return fmt::format(
      "Recorded and simulated people differ by more than chance in {} of {} paired t-tests: the "
      "smallest p is {} after Holm, below {}.",
      more, tests, p_value(smallest), report::short_number(SimulatedSide::kAlpha));
}

report::Figure figure_simulated(const StudyRecord& record) {
  report::Figure figure{
      .name = kSimulatedFigure,
      .caption =
          "Participants as recorded (coloured), simulated subjects (grey) and the paper "
          "(black): means, with one standard deviation on either side.",
      .panels = {},
      .columns = 3,
      .width_px = 980,
      .height_px = 330};
  const auto add = [](report::Panel& panel, const MetricSample& sample, double place,
                      Colour colour) {
    const double deviation = sample.standard_deviation.value_or(0.0);
    panel.series.push_back({.kind = Kind::kErrorBars,
                            .colour = colour,
                            .x = {place},
                            .y = {sample.mean},
                            .y_low = {sample.mean - deviation},
                            .y_high = {sample.mean + deviation}});
  };
  for (std::size_t k = 0; k < kMetricCount; ++k) {
    report::Panel panel;
    panel.title = kMetrics[k].title;
    panel.y.low = 0.0;
    panel.legend = report::Legend::kNone;
    report::Series paper{.kind = Kind::kPoints, .colour = Colour::kTarget};
    double place = 1.0;
    for (const auto& [condition, metrics] : record.analysis.conditions) {
      add(panel, metrics[k], place - 0.2, colour_of(condition));
      const auto made = record.simulated->analysis.conditions.find(condition);
      if (made != record.simulated->analysis.conditions.end()) {
        add(panel, made->second[k], place, Colour::kNeutral);
      }
      if (condition <= kC) {
        paper.x.push_back(place + 0.2);
        paper.y.push_back(paper_value(k, condition));
      }
      panel.x.ticks.push_back({place, name_of(condition)});
      place += 1.0;
    }
    panel.x.low = 0.4;
    panel.x.high = place - 0.4;
    if (!paper.x.empty()) panel.series.push_back(paper);
    figure.panels.push_back(panel);
  }
  return figure;
}

void add_simulated(report::Page& page, const StudyRecord& record, const report::Drawing* drawing) {
  if (!record.simulated) return;
  const SimulatedSide& simulated = *record.simulated;
  page.section("Comparison with simulated subjects");
  page.paragraph(
      simulated.same_people
          ? "The participants of this experiment are simulated. The same ones run again in one "
            "process, trial by trial, with the same bodies, motions, targets and remnants, without "
            "the bus. The difference comes from the bus and the clock, and from trials that ended "
            "early, which do not run again."
          : fmt::format(
                "As many subjects of the population (seed {}) track with trials of the same "
                "length. They are other people, so the comparison is not person by person.",
                simulated.seed));
  std::vector<std::string> failed;
  for (const auto& [code, why] : simulated.failed) {
    failed.push_back(fmt::format("{}: not simulated: {}", code, why));
  }
  if (!failed.empty()) page.list(failed);
  if (simulated.results.empty()) return;
  page.table(means_table(record));
  if (drawing != nullptr) page.figure(*drawing);
  if (!simulated.same_people) return;
  page.table(paired_table(simulated));
  page.paragraph(chance_sentence(simulated));
}

}  // namespace stillhand::study
