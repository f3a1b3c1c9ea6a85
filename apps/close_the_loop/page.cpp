// SPDX-License-Identifier: Apache-2.0
// The report: what the paper's model lacked, and what its loss did to the hand.
#include <algorithm>
#include <cmath>

#include "apps/close_the_loop/output.hpp"
#include "apps/diagnose/page/wording.hpp"
#include "apps/measurement/grid.hpp"
#include "apps/report/text.hpp"
#include "apps/session/paper_table.hpp"
#include "services/diagnosis/core/model/evaluation.hpp"
#include "services/diagnosis/core/working_set.hpp"
#include "version.hpp"

namespace stillhand::close_the_loop {
namespace {

using report::Cell;
using report::Colour;
using report::Emphasis;
using report::number;
using session::kMetrics;

constexpr double kExcerpt_s = 12.0;

struct Shown {
  const TrialRun* trial;
  Colour colour;
};

std::vector<Shown> shown(const LoopResult& result) {
  return {{&result.trial("A"), Colour::kConditionA},
          {&result.trial("B"), Colour::kConditionB},
          {&result.trial("C"), Colour::kConditionC},
          {&result.plus(), Colour::kConditionCPlus}};
}

// Bars of one metric, a condition each.
report::Panel metric_panel(const LoopResult& result, std::size_t metric) {
  report::Panel panel;
  panel.title = kMetrics[metric].title;
  panel.x.ticks = {};
  panel.y.low = 0.0;
  panel.legend = report::Legend::kNone;
  double at = 0.0;
  for (const Shown& each : shown(result)) {
    at += 1.0;
    report::Series bar;
    bar.kind = report::Kind::kBars;
    bar.colour = each.colour;
    bar.x = {at};
    bar.y = {kMetrics[metric].of(each.trial->metrics)};
    panel.series.push_back(bar);
    panel.x.ticks.push_back({at, each.trial->label});
  }
  panel.x.low = 0.4;
  panel.x.high = at + 0.6;
  return panel;
}

report::Figure tracking_figure(const LoopResult& result) {
  report::Figure figure;
  figure.name = "tracking";
  figure.caption =
      "The paper's three metrics: A platform still, B moving, C cancelled by the paper's model, C+ "
      "by the control model whose gain and phase are followed.";
  figure.columns = 3;
  for (std::size_t k = 0; k < kMetrics.size(); ++k) {
    figure.panels.push_back(metric_panel(result, k));
  }
  return figure;
}

std::vector<double> part(const std::vector<double>& values, std::size_t from, std::size_t count,
                         std::size_t stride, double factor) {
  std::vector<double> out;
  for (std::size_t n = from; n < std::min(from + count, values.size()); n += stride) {
    out.push_back(factor * values[n]);
  }
  return out;
}

report::Series line(const char* label, Colour colour, std::vector<double> x,
                    std::vector<double> y) {
  report::Series series;
  series.label = label;
  series.colour = colour;
  series.x = std::move(x);
  series.y = std::move(y);
  return series;
}

// Ten seconds of the pegged force, and what the models leave of it.
report::Figure force_figure(const LoopRecord& record) {
  const Verdict& verdict = record.result.verdict();
  const diagnosis::Signals signals(
      diagnosis::working_set(measurement::on_grid(record.result.trial("I").measured, 60'000'000),
                             {"a_y"}),
      {"a_y"}, "f");
  const auto run = [&](const diagnosis::Model& model) {
    return diagnosis::free_run(model, signals).prediction;
  };
  const std::vector<double> before = run(verdict.body.baseline.model);
  const std::vector<double> after = run(verdict.body.model);
  const std::vector<double>& force = signals.output().values;
  const auto count = static_cast<std::size_t>(kExcerpt_s * signals.rate_hz());
  const std::size_t from = (signals.size() - std::min(count, signals.size())) / 2;
  std::vector<double> time = part(signals.time_s(), from, count, 1, 1.0);
  const double begin = time.empty() ? 0.0 : time.front();
  for (double& t : time) t -= begin;
  const auto left = [&](const std::vector<double>& predicted) {
    std::vector<double> out;
    for (std::size_t n = from; n < std::min(from + count, signals.size()); ++n) {
      out.push_back(force[n] - predicted[n]);
    }
    return out;
  };
  report::Figure figure;
  figure.name = "force";
  figure.caption =
      "Force of the idle hand on the pegged stick: measured and predicted from what is sensed "
      "(free "
      "run), and below what each model leaves.";
  figure.height_px = 520;
  report::Panel top;
  top.y.label = "force [N]";
  top.series = {line("measured", Colour::kMeasured, time, part(force, from, count, 1, 1.0)),
                line("diagnosed model", Colour::kAccent, time, part(after, from, count, 1, 1.0))};
  report::Panel bottom;
  bottom.x.label = "time [s]";
  bottom.y.label = "left [N]";
  bottom.series = {line("linear model", Colour::kWarning, time, left(before)),
                   line("diagnosed model", Colour::kAccent, time, left(after))};
  figure.panels = {top, bottom};
  return figure;
}

// What the canceller followed in the newest C+; in C nothing is.
report::Figure adaptation_figure(const LoopResult& result) {
  report::Figure figure;
  figure.name = "adaptation";
  figure.caption =
      "Gain and phase as the canceller follows them through C+: the motor takes away w₀ times the "
      "prediction and w₁ times its derivative over Ω (1.2 Hz). 1 and 0 are the model as it is.";
  figure.columns = 2;
  const TrialRun& plus = result.plus();
  std::vector<double> time;
  for (std::size_t n = 0; n < plus.weights.size(); ++n) {
    time.push_back(static_cast<double>(n) / kWeightRate_hz);
  }
  for (const std::size_t k : {0U, 1U}) {
    report::Panel panel;
    panel.title = k == 0 ? "gain w₀ [-]" : "phase w₁ [-]";
    panel.x.label = "time [s]";
    panel.legend = report::Legend::kNone;
    std::vector<double> values;
    for (const auto& pair : plus.weights) values.push_back(pair[k]);
    const auto [low, high] = std::ranges::minmax(values);
    panel.y.low = std::min(low, static_cast<double>(1 - k)) - 0.1;
    panel.y.high = std::max(high, static_cast<double>(1 - k)) + 0.1;
    panel.series = {line("", Colour::kConditionCPlus, time, values)};
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

// Target and cursor, the same twelve seconds under every condition that moves.
report::Figure motion_figure(const LoopResult& result) {
  report::Figure figure;
  figure.name = "motion";
  figure.caption = "Target and cursor, twelve seconds from the middle of each trial.";
  figure.columns = 1;
  const auto conditions = shown(result);
  figure.height_px = 200 * static_cast<int>(conditions.size());
  double largest = 0.0;  // one scale for all: they are to be compared
  for (const Shown& each : conditions) {
    const recording::Recording& rows = each.trial->measured;
    const auto count = static_cast<std::size_t>(kExcerpt_s * rows.rate_hz);
    const std::size_t from = (rows.row_count() - std::min(count, rows.row_count())) / 2;
    std::vector<double> time = part(rows.time_s, from, count, 20, 1.0);
    const double begin = time.empty() ? 0.0 : time.front();
    for (double& t : time) t -= begin;
    report::Panel panel;
    panel.title = each.trial->label;
    panel.y.label = "[mm]";
    if (&each == &conditions.back()) panel.x.label = "time [s]";
    panel.series = {
        line("target", Colour::kTarget, time, part(rows.find("x_r")->values, from, count, 20, 1e3)),
        line("cursor", each.colour, time, part(rows.find("x_p")->values, from, count, 20, 1e3))};
    for (const report::Series& series : panel.series) {
      for (const double y : series.y) largest = std::max(largest, std::abs(y));
    }
    figure.panels.push_back(std::move(panel));
  }
  for (report::Panel& panel : figure.panels) {
    panel.y.low = -1.05 * largest;
    panel.y.high = 1.05 * largest;
  }
  return figure;
}

std::string percent(double share) { return number(100.0 * share, 0) + " %"; }

report::Table tracking_table(const LoopResult& result) {
  report::Table table;
  table.caption = "Tracking, and the share of A's that C and C+ restore: (B − X)/(B − A)";
  table.header = {"", "A", "B", "C", "C+", "C restores", "C+ restores", "paper's C restores"};
  for (std::size_t k = 0; k < kMetrics.size(); ++k) {
    const auto value = [&](const TrialRun& trial) {
      return number(kMetrics[k].of(trial.metrics), k == 0 ? 1 : 3);
    };
    table.rows.push_back({kMetrics[k].title, value(result.trial("A")), value(result.trial("B")),
                          value(result.trial("C")), Cell(value(result.plus()), Emphasis::kStrong),
                          percent(restoration(result, result.trial("C"), k)),
                          Cell(percent(restoration(result, result.plus(), k)), Emphasis::kStrong),
                          number(kMetrics[k].paper_restored_percent, 0) + " %"});
  }
  table.rows.push_back({"feedthrough force cancelled", "", "",
                        percent(result.trial("C").cancelled_share),
                        Cell(percent(result.plus().cancelled_share), Emphasis::kStrong)});
  const auto late = [](const TrialRun& trial) {
    return number(1e3 * trial.counterforce_delay_s, 1) + " ms";
  };
  table.rows.push_back({"the motor opposes it late by", "", "", late(result.trial("C")),
                        Cell(late(result.plus()), Emphasis::kStrong)});
  return table;
}

report::Table prediction_table(const Verdict& verdict) {
  report::Table table;
  table.caption =
      "Prediction of the force on samples that no fit has seen: root mean square error and its 95 "
      "% "
      "interval over the blocks";
  table.header = {"model", "error [N]", "95 % [N]", "what it takes on"};
  table.align = {report::Align::kLeft, report::Align::kRight, report::Align::kRight,
                 report::Align::kLeft};
  const auto row = [&](const std::string& name, const diagnosis::HeldOutError& error,
                       const std::string& words) {
    table.rows.push_back({name, number(error.rmse, 4),
                          number(error.low, 4) + " to " + number(error.high, 4), words});
  };
  row("linear, of a_y", verdict.body.baseline_error, "");
  for (const diagnosis::FoundEffect& effect : verdict.body.effects) {
    row("+ " + effect.effect.kind, effect.after, diagnose::shown_sentence(effect.evidence, "N"));
  }
  table.rows.push_back({"noise floor", number(verdict.body.noise_floor.rmse, 4), "", ""});
  return table;
}

report::Table treatment_table(const Round& round) {
  const Verdict& verdict = round.verdict;
  report::Table table;
  table.caption = "What the canceller makes of it";
  table.header = {"effect", "cancelled", "how"};
  table.align = {report::Align::kLeft, report::Align::kLeft, report::Align::kLeft};
  for (const Treatment& each : verdict.control.treatments) {
    table.rows.push_back(
        {each.kind,
         each.cancelled && round.augmented ? Cell("yes", Emphasis::kGood)
                                           : Cell("no", Emphasis::kFaint),
         round.augmented ? each.how : "C+ ran without it: the model was not taken"});
  }
  return table;
}

std::string lead(const LoopRecord& record) {
  const LoopResult& result = record.result;
  const std::string kind = result.verdict().kind();
  return (kind == "none" ? std::string("The paper's model lacks nothing that moves a hand; ")
                         : "The paper's model lacks: " + kind + ". ") +
         "C restores " + percent(restoration(result, result.trial("C"), 0)) +
         " of the tracking error that the motion costs, C+ " +
         percent(restoration(result, result.plus(), 0)) + ", the paper 47 %.";
}

}  // namespace

std::vector<report::Figure> loop_figures(const LoopRecord& record) {
  return {tracking_figure(record.result), force_figure(record), adaptation_figure(record.result),
          motion_figure(record.result)};
}

report::Page loop_page(const LoopRecord& record, const std::vector<report::Drawing>& drawings) {
  const LoopResult& result = record.result;
  const Verdict& verdict = result.verdict();
  report::Page page("Closing the loop", lead(record));
  page.facts({{"command", record.command_line},
              {"seed", std::to_string(record.options.protocol.seed)},
              {"version", kVersion}});
  page.section("Is the hand stiller?");
  page.figure(drawings.at(0));
  page.table(tracking_table(result));
  page.paragraph(
      "The trials of C and C+ have the same motion and target. The force that was cancelled is "
      "judged by the rig's own truth, which no diagnosis reads.");
  page.section("What the model lacked");
  if (verdict.findings.empty()) page.paragraph("Nothing that is worth a motor's while.");
  std::vector<std::string> findings;
  for (const Finding& each : verdict.findings) {
    findings.push_back(each.kind + (each.channel.empty() ? "" : " (" + each.channel + ")") +
                       " in the " + each.where + ", " + number(each.explained_n, 2) +
                       " N RMS: " + each.evidence + ".");
  }
  if (!findings.empty()) page.list(findings);
  page.table(prediction_table(verdict));
  page.figure(drawings.at(1));
  if (!verdict.control.treatments.empty())
    page.table(treatment_table(result.rounds[result.final_round]));
  if (verdict.latency) {
    page.paragraph("Delay from the motor's command to the force: " +
                   number(1e3 * verdict.latency->motor_s, 1) + " ms, of the load cell " +
                   number(1e3 * verdict.latency->cell_s, 1) +
                   " ms, by the stick's own equation. The prediction comes as much sooner.");
  }
  page.section("The rounds");
  report::Table rounds;
  rounds.caption = "Every model that was tried";
  rounds.header = {"round", "RMS error [mm]", "gain w₀", "phase w₁", "outcome"};
  rounds.align = {report::Align::kLeft, report::Align::kRight, report::Align::kRight,
                  report::Align::kRight, report::Align::kLeft};
  for (std::size_t i = 0; i < result.rounds.size(); ++i) {
    const Round& each = result.rounds[i];
    std::vector<Cell> row{std::to_string(i + 1), number(each.trial.metrics.rms_error_mm, 1), "–",
                          "–", each.outcome};
    if (const auto& weights = each.trial.weights; !weights.empty()) {
      row[2] = number(weights.back()[0], 2);
      row[3] = number(weights.back()[1], 2);
    }
    rounds.rows.push_back(row);
  }
  page.table(rounds);
  page.figure(drawings.at(2));
  page.figure(drawings.at(3));
  if (record.truth) {
    page.section("The sealed truth");
    page.paragraph("Opened after the verdict: " + record.truth->kind +
                   (record.truth->place.empty() ? "" : ", " + record.truth->place) +
                   (record.truth->numbers.empty() ? "" : " (" + record.truth->numbers + ")") +
                   ". The verdict is " + (record.right() ? "right." : "wrong."));
  }
  return page;
}

}  // namespace stillhand::close_the_loop
