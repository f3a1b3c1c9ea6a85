// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/recorded/recorded_output.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/close_the_loop/output.hpp"
#include "apps/diagnose/page/wording.hpp"
#include "apps/report/or_null.hpp"
#include "apps/report/text.hpp"
#include "version.hpp"

namespace stillhand::close_the_loop {
namespace {

using nlohmann::ordered_json;
using report::number;

using Interval = std::optional<std::pair<double, double>>;

ordered_json interval_json(const Interval& interval) {
  if (!interval) return nullptr;
  return {interval->first, interval->second};
}

ordered_json level_json(const Level& level) {
  return {{"rms", level.rms}, {"interval95", interval_json(level.interval95)}};
}

ordered_json remaining_json(const std::optional<Remaining>& remaining) {
  if (!remaining) return nullptr;
  return {{"left", level_json(remaining->left)},
          {"cut", remaining->cut()},
          {"cut_interval95", interval_json(remaining->cut_interval95())}};
}

ordered_json judged_json(const Judged& judged) {
  return {{"source", judged.source},
          {"seconds", judged.seconds},
          {"without", level_json(judged.linear.without)},
          {"linear", remaining_json(judged.linear)},
          {"augmented", remaining_json(judged.augmented)},
          {"motor_linear", remaining_json(judged.motor_linear)},
          {"motor_augmented", remaining_json(judged.motor_augmented)}};
}

std::string level_text(const Level& level) {
  std::string text = report::short_number(level.rms);
  if (!level.interval95) return text;
  return fmt::format("{} [{}, {}]", text, report::short_number(level.interval95->first),
                     report::short_number(level.interval95->second));
}

std::string cut_text(const Remaining& remaining) {
  std::string text = number(100.0 * remaining.cut(), 1) + " %";
  const Interval interval = remaining.cut_interval95();
  if (!interval) return text;
  return fmt::format("{} [{}, {}]", text, number(100.0 * interval->first, 1),
                     number(100.0 * interval->second, 1));
}

// The rows of both tables: what acted, what is left, what share it took away.
struct Row {
  const char* what;
  std::string left;
  std::string cut;
};

std::vector<Row> rows_of(const Judged& judged) {
  std::vector<Row> rows{{"nothing", level_text(judged.linear.without), ""},
                        {"the linear model's prediction taken off", level_text(judged.linear.left),
                         cut_text(judged.linear)},
                        {"the augmented model's prediction taken off",
                         level_text(judged.augmented.left), cut_text(judged.augmented)}};
  const auto motor = [&](const char* what, const std::optional<Remaining>& remaining) {
    if (remaining) rows.push_back({what, level_text(remaining->left), cut_text(*remaining)});
  };
  motor("the motor with the linear model (C)", judged.motor_linear);
  motor("the motor with the augmented model (C+)", judged.motor_augmented);
  return rows;
}

std::string finding_text(const Finding& finding, const std::string& unit) {
  return fmt::format("{}{} in the {}, {} {} RMS: {}", diagnose::spaced(finding.kind),
                     finding.channel.empty() ? "" : " (" + finding.channel + ")", finding.where,
                     report::short_number(finding.explained_n), diagnose::shown_unit(unit),
                     finding.evidence);
}

std::string conclusion_text(const Verdict& verdict) {
  if (!verdict.findings.empty()) return {};
  return verdict.conclusion() == kUnexplained
             ? "The residual has a cause that no kind of effect explains."
             : "The model lacks nothing that is large enough to move a hand.";
}

// What became of the augmented model on the unseen records.
std::string kept_text(const RecordedLoop& loop) {
  if (loop.verdict.body.effects.empty()) return {};
  return loop.kept ? "The augmented model leaves less on the unseen records: it is kept."
                   : "The augmented model leaves more on the unseen records: the linear model is "
                     "kept, also for the canceller.";
}

// Why no motor ran, or ran with one model alone; empty: both ran.
std::string motor_text(const RecordedLoop& loop) {
  if (!loop.no_motor.empty()) return "No motor was run: " + loop.no_motor + ".";
  std::string text;
  const auto add = [&](const char* model, const std::string& why) {
    if (why.empty()) return;
    text += fmt::format("{}The motor was not run with the {} model: {}.", text.empty() ? "" : " ",
                        model, why);
  };
  add("linear", loop.linear_not_carried);
  add("augmented", loop.verdict.not_carried);
  return text;
}

}  // namespace

std::string recorded_summary_json(const RecordedLoop& loop, const RecordedOptions& options) {
  ordered_json summary;
  summary["recordings"] = {{"pegged", options.pegged},
                           {"moving", options.moving},
                           {"cancelled", options.cancelled},
                           {"unseen", options.unseen}};
  summary["inputs"] = options.inputs;
  summary["output"] = options.output;
  summary["unit"] = loop.unit;
  summary["verdict"] = ordered_json::parse(verdict_json(loop.verdict));
  summary["prediction"] = prediction_json(loop.verdict);
  summary["latency"] = latency_json(loop.verdict.latency);
  summary["treatments"] = treatments_json(loop.verdict.control);
  summary["unseen"] = ordered_json::array();
  for (const Judged& judged : loop.judged) summary["unseen"].push_back(judged_json(judged));
  summary["kept"] = loop.kept;
  summary["no_motor"] = report::or_null(loop.no_motor);
  summary["linear_not_carried"] = report::or_null(loop.linear_not_carried);
  summary["not_carried"] = report::or_null(loop.verdict.not_carried);
  summary["notes"] = loop.notes;
  summary["version"] = kVersion;
  return summary.dump(2) + "\n";
}

void print_recorded(const RecordedLoop& loop) {
  for (const std::string& note : loop.notes) fmt::print("note: {}\n", note);
  for (const Finding& finding : loop.verdict.findings) {
    fmt::print("missing: {}\n", finding_text(finding, loop.unit));
  }
  if (loop.verdict.findings.empty()) fmt::print("{}\n", conclusion_text(loop.verdict));
  for (const Judged& judged : loop.judged) {
    fmt::print("\n{}, {:.0f} s that no fit has seen\n{:<44} {:<28} {}\n", judged.source,
               judged.seconds, "what acts against the force",
               fmt::format("left [{}], 95 %", diagnose::shown_unit(loop.unit)), "cut");
    for (const Row& row : rows_of(judged)) {
      fmt::print("{:<44} {:<28} {}\n", row.what, row.left, row.cut);
    }
  }
  for (const std::string& text : {kept_text(loop), motor_text(loop)}) {
    if (!text.empty()) fmt::print("\n{}\n", text);
  }
}

report::Page recorded_page(const RecordedLoop& loop, const RecordedOptions& options,
                           const std::string& command_line,
                           const std::vector<report::Drawing>& drawings) {
  const Verdict& verdict = loop.verdict;
  const Judged& last = loop.judged.back();
  report::Page page(
      "Closing the loop from recordings",
      fmt::format("{} On {}, which no fit has seen, the linear model takes {} of the force away "
                  "and the augmented model {}.",
                  verdict.findings.empty()
                      ? conclusion_text(verdict)
                      : "Missing: " + finding_text(verdict.findings.front(), loop.unit) + ".",
                  last.source, cut_text(last.linear), cut_text(last.augmented)));
  page.facts({{"command", command_line},
              {"inputs", fmt::format("{}", fmt::join(options.inputs, ", "))},
              {"output", diagnose::axis_label(options.output, loop.unit)},
              {"version", kVersion}});
  page.section("What is left on unseen records");
  for (const Judged& judged : loop.judged) {
    report::Table table;
    table.caption = fmt::format("{}, {:.0f} s: RMS about the mean, and the share of it taken away",
                                judged.source, judged.seconds);
    table.header = {"what acts against the force",
                    fmt::format("left [{}], 95 %", diagnose::shown_unit(loop.unit)), "cut, 95 %"};
    for (const Row& row : rows_of(judged)) table.rows.push_back({row.what, row.left, row.cut});
    page.table(table);
  }
  for (const std::string& text : {kept_text(loop), motor_text(loop)}) {
    if (!text.empty()) page.paragraph(text);
  }
  for (const report::Drawing& drawing : drawings) page.figure(drawing);
  page.section("What the model lacks");
  std::vector<std::string> findings;
  for (const Finding& finding : verdict.findings) {
    findings.push_back(finding_text(finding, loop.unit) + ".");
  }
  if (findings.empty()) page.paragraph(conclusion_text(verdict));
  if (!findings.empty()) page.list(findings);
  if (!verdict.control.treatments.empty()) page.table(treatment_table(verdict.control, loop.kept));
  return page;
}

namespace {

// A panel with the bars of one record.
report::Panel bars(const RecordedLoop& loop, const Judged& judged) {
  report::Panel panel;
  panel.title = judged.source;
  panel.y.label = "left [" + diagnose::shown_unit(loop.unit) + "]";
  panel.y.low = 0.0;
  panel.legend = report::Legend::kNone;
  double at = 0.0;
  const auto bar = [&](const char* label, report::Colour colour, const Level& level) {
    at += 1.0;
    panel.series.push_back(
        {.kind = report::Kind::kBars, .colour = colour, .x = {at}, .y = {level.rms}});
    if (level.interval95) {
      panel.series.push_back({.kind = report::Kind::kErrorBars,
                              .colour = report::Colour::kTarget,
                              .x = {at},
                              .y = {level.rms},
                              .y_low = {level.interval95->first},
                              .y_high = {level.interval95->second},
                              .point_size = 0.1});
    }
    panel.x.ticks.push_back({at, label});
  };
  bar("nothing", report::Colour::kMeasured, judged.linear.without);
  bar("linear", report::Colour::kWarning, judged.linear.left);
  bar("augmented", report::Colour::kAccent, judged.augmented.left);
  if (judged.motor_linear) bar("C", report::Colour::kConditionC, judged.motor_linear->left);
  if (judged.motor_augmented) {
    bar("C+", report::Colour::kConditionCPlus, judged.motor_augmented->left);
  }
  panel.x.low = 0.4;
  panel.x.high = at + 0.6;
  return panel;
}

report::Series line(const char* label, report::Colour colour, const Excerpt& excerpt,
                    const std::vector<double>& values) {
  report::Series out{.label = label, .colour = colour, .x = {}, .y = values};
  for (std::size_t n = 0; n < values.size(); ++n) {
    out.x.push_back(static_cast<double>(n) / excerpt.rate_hz);
  }
  return out;
}

// Twelve seconds of one record: the force, and what each model leaves.
report::Panel trace(const RecordedLoop& loop, const Judged& judged) {
  report::Panel panel;
  panel.title = judged.source;
  panel.x.label = "time [s]";
  panel.y.label = "[" + diagnose::shown_unit(loop.unit) + "]";
  const Excerpt& linear = judged.linear.excerpt;
  const Excerpt& augmented = judged.augmented.excerpt;
  panel.series = {
      line("measured", report::Colour::kMeasured, linear, linear.force),
      line("left by the linear model", report::Colour::kWarning, linear, linear.left),
      line("left by the augmented model", report::Colour::kAccent, augmented, augmented.left)};
  return panel;
}

}  // namespace

std::vector<report::Figure> recorded_figures(const RecordedLoop& loop) {
  report::Figure traces;
  traces.name = "force";
  traces.caption = "Twelve seconds from the middle of each unseen record.";
  traces.columns = 1;
  traces.height_px = 340 * static_cast<int>(loop.judged.size());
  report::Figure figure;
  figure.name = "left";
  figure.caption =
      "What is left of the force on each unseen record, and its 95 % interval over blocks of 10 s.";
  figure.columns = static_cast<int>(loop.judged.size());
  for (const Judged& judged : loop.judged) {
    figure.panels.push_back(bars(loop, judged));
    traces.panels.push_back(trace(loop, judged));
  }
  return {figure, traces};
}

}  // namespace stillhand::close_the_loop
