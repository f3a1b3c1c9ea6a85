// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/recorded_output.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/close_the_loop/output.hpp"
#include "apps/close_the_loop/recorded_words.hpp"
#include "apps/diagnose/page/wording.hpp"
#include "apps/libraries/report/or_null.hpp"
#include "apps/libraries/report/provenance.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "version.hpp"

namespace stillhand::close_the_loop {
namespace {

using nlohmann::ordered_json;
using report::number;

using Interval = std::optional<std::pair<double, double>>;

ordered_json level_json(const Level& level) {
  return {{"rms", level.rms}, {"interval95", report::or_null(level.interval95)}};
}

ordered_json remaining_json(const std::optional<Remaining>& remaining) {
  if (!remaining) return nullptr;
  return {{"left", level_json(remaining->left)},
          {"cut", remaining->cut()},
          {"cut_interval95", report::or_null(remaining->cut_interval95())}};
}

// What the effects explain of a record that no fit has seen.
ordered_json force_json(const Level& level) {
  return {{"value", level.rms}, {"ci95", report::or_null(level.interval95)}};
}

ordered_json judged_json(const Judged& judged) {
  return {{"source", judged.source},
          {"seconds", judged.seconds},
          {"without", level_json(judged.linear.without)},
          {"linear", remaining_json(judged.linear)},
          {"augmented", remaining_json(judged.augmented)},
          {"force_n", force_json(explained_beyond(judged.linear.left, judged.augmented.left))},
          {"motor_linear", remaining_json(judged.motor_linear)},
          {"motor_augmented", remaining_json(judged.motor_augmented)}};
}

ordered_json decision_json(const Decision& decision) {
  if (!decision.step) return nullptr;
  return {{"linear", level_json(decision.step->without)},
          {"augmented", level_json(decision.step->left)},
          {"less", decision.step->cut()},
          {"less_interval95", report::or_null(decision.step->cut_interval95())},
          {"worse", decision.worse}};
}

// The rows of both tables: what acted, what is left, what share it took away.
report::Table table_of(const Judged& judged, const std::string& unit) {
  report::Table table;
  table.caption = fmt::format(
      "{}, {:.0f} s that no fit has seen: RMS about the mean, and the share of it taken away",
      judged.source, judged.seconds);
  table.header = {"what acts against the force",
                  fmt::format("left [{}], 95 %", diagnose::shown_unit(unit)), "cut, 95 %"};
  table.rows = {{"nothing", level_text(judged.linear.without)}};
  const auto row = [&](const char* what, const std::optional<Remaining>& remaining) {
    if (!remaining) return;
    table.rows.push_back({what, level_text(remaining->left), cut_text(*remaining)});
  };
  row("less the linear model's prediction", judged.linear);
  row("less the augmented model's prediction", judged.augmented);
  row("the motor with the linear model (C)", judged.motor_linear);
  row("the motor with the augmented model (C+)", judged.motor_augmented);
  return table;
}

}  // namespace

std::string recorded_summary_json(const RecordedLoop& loop, const RecordedOptions& options) {
  ordered_json summary;
  summary["recordings"] = {{"pegged", options.pegged},
                           {"moving", options.moving},
                           {"cancelled", options.cancelled},
                           {"unseen", options.unseen}};
  summary["inputs"] = options.diagnose.inputs;
  summary["output"] = options.diagnose.output;
  summary["unit"] = loop.unit;
  summary["verdict"] = ordered_json::parse(verdict_json(loop.verdict));
  summary["prediction"] = prediction_json(loop.verdict);
  summary["latency"] = latency_json(loop.verdict.latency);
  summary["treatments"] = treatments_json(loop.verdict.control);
  summary["unseen"] = ordered_json::array();
  for (const Judged& judged : loop.judged) summary["unseen"].push_back(judged_json(judged));
  summary["kept"] = loop.decision.kept();
  summary["decided_on"] = loop.decision.by_motor ? "motor" : "prediction";
  summary["decision"] = decision_json(loop.decision);
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
    fmt::print("{}: {}\n", finding.counts ? "missing" : "found", finding_text(finding, loop.unit));
  }
  if (loop.verdict.strongest() == nullptr) fmt::print("{}\n", conclusion_text(loop));
  if (!loop.decision.same) fmt::print("{}\n", unseen_size_text(loop));
  for (const Judged& judged : loop.judged) {
    fmt::print("\n{}", report::in_plain_text(table_of(judged, loop.unit)));
  }
  for (const std::string& text : {kept_text(loop), motor_text(loop), parted_text(loop)}) {
    if (!text.empty()) fmt::print("\n{}\n", text);
  }
}

report::Page recorded_page(const RecordedLoop& loop, const RecordedOptions& options,
                           const std::string& command_line,
                           const std::vector<report::Drawing>& drawings) {
  const Verdict& verdict = loop.verdict;
  const std::string missing =
      verdict.strongest() == nullptr
          ? conclusion_text(loop)
          : "Missing: " + finding_text(*verdict.strongest(), loop.unit) + ".";
  report::Page page("Closing the loop from recordings",
                    fmt::format("{} {} {}", missing, cuts_text(loop), kept_text(loop)));
  page.facts({{"command", command_line},
              {"inputs", fmt::format("{}", fmt::join(options.diagnose.inputs, ", "))},
              {"output", diagnose::axis_label(options.diagnose.output, loop.unit)},
              {"made by", report::made_by()}});
  page.section("What is left on unseen records");
  for (const Judged& judged : loop.judged) page.table(table_of(judged, loop.unit));
  for (const std::string& text : {kept_text(loop), motor_text(loop), parted_text(loop)}) {
    if (!text.empty()) page.paragraph(text);
  }
  for (const report::Drawing& drawing : drawings) page.figure(drawing);
  page.section("What the model lacks");
  std::vector<std::string> findings;
  for (const Finding& finding : verdict.findings) {
    findings.push_back(finding_text(finding, loop.unit) + ".");
  }
  if (verdict.strongest() == nullptr) page.paragraph(conclusion_text(loop));
  if (!findings.empty()) page.list(findings);
  if (!loop.decision.same) page.paragraph(unseen_size_text(loop));
  if (!verdict.control.treatments.empty())
    page.table(treatment_table(verdict.control, loop.decision.kept()));
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
  const auto bar = [&](const char* label, report::Colour colour, const Level& level) {
    add_bar(panel, label, colour, level.rms, level.interval95);
  };
  bar("nothing", report::Colour::kMeasured, judged.linear.without);
  bar("linear", report::Colour::kWarning, judged.linear.left);
  bar("augmented", report::Colour::kAccent, judged.augmented.left);
  if (judged.motor_linear) bar("C", report::Colour::kConditionC, judged.motor_linear->left);
  if (judged.motor_augmented) {
    bar("C+", report::Colour::kConditionCPlus, judged.motor_augmented->left);
  }
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
