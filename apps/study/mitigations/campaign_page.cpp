// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "apps/libraries/report/provenance.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "apps/study/mitigations/campaign_output.hpp"

namespace stillhand::study {
namespace {

using report::Cell;
using report::Colour;
using report::Kind;
using report::number;
using report::Series;

constexpr std::array kModels{ModelOf::kNone, ModelOf::kOwn, ModelOf::kAverage, ModelOf::kOther};
constexpr std::array<const char*, 4> kModelWords{"no model", "own model", "average model",
                                                 "another's model"};
constexpr std::array kColours{Colour::kNeutral, Colour::kConditionC, Colour::kModel,
                              Colour::kWarning};
constexpr double kPercent = 100.0;

// Points and intervals of one model, a row for each mitigation, the first at the top.
void add_series(report::Panel& panel, const Campaign& campaign, TrialTask task, TrialMotion motion,
                std::size_t model) {
  const auto& wanted = campaign.options.mitigations;
  Series points{.label = kModelWords[model], .kind = Kind::kPoints, .colour = kColours[model]};
  Series bars{.kind = Kind::kLine, .colour = kColours[model], .show_in_legend = false};
  for (const CellFigures& cell : campaign.cells) {
    const CellKey& key = cell.key;
    if (key.task != task || key.motion != motion || key.model != kModels[model]) continue;
    if (key.mitigation == kB || !cell.restored_median) continue;
    std::size_t row = 0;
    while (wanted[row] != key.mitigation) ++row;
    const double aside = key.model == ModelOf::kOwn     ? 0.22
                         : key.model == ModelOf::kOther ? -0.22
                                                        : 0.0;
    const double at = static_cast<double>(wanted.size() - row) + aside;
    points.x.push_back(kPercent * cell.restored_median->median);
    points.y.push_back(at);
    for (const double end : {cell.restored_median->low, cell.restored_median->high}) {
      bars.x.push_back(kPercent * end);
      bars.y.push_back(at);
    }
    bars.x.push_back(NAN);
    bars.y.push_back(NAN);
  }
  if (points.x.empty()) return;
  panel.series.push_back(bars);
  panel.series.push_back(points);
}

report::Figure figure_of(const Campaign& campaign, TrialTask task) {
  const auto& wanted = campaign.options.mitigations;
  report::Figure out;
  const char* word = kTrialTaskNames[static_cast<std::size_t>(task)];
  out.name = fmt::format("mitigations_{}", word);
  out.caption = fmt::format(
      "Task {}: share of the error from motion that each mitigation takes away; median over {} "
      "people and its 95 % interval. 0: as without a mitigation, 100: as without motion.",
      word, campaign.options.subjects);
  out.columns = static_cast<int>(campaign.options.motions.size());
  out.width_px = 1200;
  out.height_px = 110 + 30 * static_cast<int>(wanted.size());
  for (const TrialMotion motion : campaign.options.motions) {
    report::Panel panel;
    panel.title = kTrialMotionNames[static_cast<std::size_t>(motion)];
    panel.x.label = "restored [%]";
    panel.x.low = -60.0;
    panel.x.high = 125.0;
    panel.y.low = 0.4;
    panel.y.high = static_cast<double>(wanted.size()) - 0.4;
    for (std::size_t row = 1; row < wanted.size(); ++row) {
      panel.y.ticks.push_back(
          {static_cast<double>(wanted.size() - row), mitigation_name(wanted[row])});
    }
    for (std::size_t model = 0; model < kModels.size(); ++model) {
      add_series(panel, campaign, task, motion, model);
    }
    panel.reference_lines = {
        {.direction = report::Direction::kVertical, .at = 0.0, .colour = Colour::kNeutral}};
    if (motion != campaign.options.motions.front()) panel.legend = report::Legend::kNone;
    out.panels.push_back(panel);
  }
  return out;
}

report::Table kinds_table(const Campaign& campaign) {
  report::Table table;
  table.caption = "What each mitigation does.";
  table.header = {"mitigation", "what it does"};
  table.align = {report::Align::kLeft, report::Align::kLeft};
  for (const Condition each : campaign.options.mitigations) {
    table.rows.push_back({mitigation_name(each), row_of(each).meaning});
  }
  return table;
}

}  // namespace

report::Table table_of(const Campaign& campaign, TrialTask task, TrialMotion motion) {
  report::Table table;
  table.caption =
      fmt::format("Task {}, motion {}.", kTrialTaskNames[static_cast<std::size_t>(task)],
                  kTrialMotionNames[static_cast<std::size_t>(motion)]);
  table.header = {"mitigation",    "model",        "RMS error [mm]", "restored, mean [95 %]",
                  "median [95 %]", "worst person", "harmed [95 %]",  "motor [N]",
                  "effort [N]"};
  const auto interval = [](double middle, double low, double high) {
    return std::isfinite(low) ? fmt::format("{:.0f} [{:.0f}, {:.0f}] %", kPercent * middle,
                                            kPercent * low, kPercent * high)
                              : fmt::format("{:.0f} %", kPercent * middle);
  };
  for (const CellFigures& cell : campaign.cells) {
    if (cell.key.task != task || cell.key.motion != motion) continue;
    std::vector<Cell> row{mitigation_name(cell.key.mitigation),
                          needs_model(cell.key.mitigation)
                              ? kModelOfNames[static_cast<std::size_t>(cell.key.model)]
                              : "",
                          number(cell.error_mm, 1)};
    if (cell.key.mitigation != kB) {
      const auto& mean = cell.restored_mean;
      row.emplace_back(mean ? interval(mean->ratio, mean->low, mean->high) : "");
      const auto& median = cell.restored_median;
      row.emplace_back(median ? interval(median->median, median->low, median->high) : "");
      row.emplace_back(cell.worst_person ? fmt::format("{:.0f} % (person {})",
                                                       kPercent * cell.restored[*cell.worst_person],
                                                       *cell.worst_person + 1)
                                         : "");
      const bool harms = cell.harm.low > 0.0;
      row.emplace_back(interval(cell.harm.share, cell.harm.low, cell.harm.high),
                       harms ? report::Emphasis::kBad : report::Emphasis::kNone);
    } else {
      for (int i = 0; i < 4; ++i) row.emplace_back("");
    }
    row.emplace_back(number(cell.motor_n, 2));
    row.emplace_back(task == TrialTask::kTrack ? number(cell.effort_n, 2) : "");
    table.rows.push_back(row);
  }
  return table;
}

std::vector<report::Figure> campaign_figures(const Campaign& campaign) {
  std::vector<report::Figure> out;
  for (const TrialTask task : campaign.options.tasks) out.push_back(figure_of(campaign, task));
  return out;
}

report::Page campaign_page(const Campaign& campaign, const std::string& command_line,
                           const std::vector<report::Drawing>& drawings) {
  report::Page page("Every mitigation",
                    "Simulated people, each with every mitigation, in the same motion and with "
                    "the same noise.");
  page.banner(report::kSimulatedBanner);
  page.facts({{"seed", std::to_string(campaign.options.seed)},
              {"people", std::to_string(campaign.options.subjects)},
              {"parameters chosen on", fmt::format("{} other people", campaign.chosen_on)},
              {"length of a trial", fmt::format("{} s, of which the first third does not count",
                                                number(campaign.options.trial_s, 0))},
              {"processor time", number(campaign.processor_s, 0) + " s"},
              {"computed in", number(campaign.wall_s, 0) + " s"},
              {"made by", report::made_by()},
              {"command line", command_line}});
  page.warning(
      "The people who are shaken and the models of them have one structure. The table compares "
      "mitigations with each other; it says nothing of people.");
  page.section("What each does");
  page.table(kinds_table(campaign));
  page.list(campaign.chosen.log);
  for (std::size_t t = 0; t < campaign.options.tasks.size(); ++t) {
    const TrialTask task = campaign.options.tasks[t];
    page.section(fmt::format("Task: {}", kTrialTaskNames[static_cast<std::size_t>(task)]));
    page.figure(drawings[t]);
    for (const TrialMotion motion : campaign.options.motions) {
      page.table(table_of(campaign, task, motion));
    }
  }
  page.section("Method");
  page.paragraph(
      "Restored: (B - M)/(B - A) of the RMS error, B with motion and nothing done, A without "
      "motion. Mean: ratio of the means with Fieller's interval; median over people with an "
      "interval between order statistics; harmed: people whose error is larger than in B, with "
      "the interval of Clopper and Pearson. Motor and effort: mean over people of the RMS of the "
      "motor's force and of the force that the person wants to give. apps/study/METHOD.md has the "
      "equations.");
  return page;
}

}  // namespace stillhand::study
