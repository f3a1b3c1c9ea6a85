// SPDX-License-Identifier: Apache-2.0
// The report: what the paper's model lacked, and how the hand tracks with each model.
#include "apps/close_the_loop/output.hpp"
#include "apps/close_the_loop/repair_output.hpp"
#include "apps/diagnose/page/wording.hpp"
#include "apps/libraries/report/provenance.hpp"
#include "apps/libraries/report/text/text.hpp"

namespace stillhand::close_the_loop {
namespace {

using report::Cell;
using report::Emphasis;
using report::number;

constexpr std::size_t kRepairDrawing = 4;  // of loop_figures(), if there is anything to repair

std::string percent(const Estimate& share) { return with_interval(share, 0, 100.0) + " %"; }

report::Table prediction_table(const Verdict& verdict) {
  report::Table table;
  table.caption =
      "Prediction of the force on samples that no fit has seen: root mean square error and its "
      "95 % interval over the blocks";
  table.header = {"model", "error [N]", "95 % [N]", "what it explains"};
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

report::Table rounds_table(const LoopResult& result) {
  report::Table table;
  table.caption = "Every model that was tried";
  table.header = {"round", "RMS error [mm]", "gain w₀", "phase w₁", "outcome"};
  table.align = {report::Align::kLeft, report::Align::kRight, report::Align::kRight,
                 report::Align::kRight, report::Align::kLeft};
  for (std::size_t i = 0; i < result.rounds.size(); ++i) {
    const Round& each = result.rounds[i];
    std::vector<Cell> row{std::to_string(i + 1), number(each.trial.metrics.rms_error_mm, 1), "–",
                          "–", each.outcome};
    if (const auto& weights = each.trial.weights; !weights.empty()) {
      row[2] = number(weights.back()[0], 2);
      row[3] = number(weights.back()[1], 2);
    }
    table.rows.push_back(row);
  }
  return table;
}

std::string lead(const LoopRecord& record) {
  const LoopResult& result = record.result;
  const Verdict& verdict = result.verdict();
  const Number& error = kNumbers[index_of("rms_error_mm")];
  const auto left = [&](const char* label) {
    const Number& force = kNumbers[index_of("force_left_n")];
    return number(measured(record.conditions, label, force).mean, 2) + " N";
  };
  const std::string lacks = verdict.strongest() != nullptr
                                ? "The paper's model lacks: " + verdict.kind() + ". "
                                : without_effect(verdict, verdict.body.options.least_force_n) + " ";
  return lacks + "Of the tracking error that the motion causes, C removes " +
         percent(restored(record.conditions, "C", error)) + ", C' " +
         percent(restored(record.conditions, "C'", error)) + ", C+ " +
         percent(restored(record.conditions, "C+", error)) +
         "; in the paper, C removes 47 %. The force that is left: C " + left("C") + ", C' " +
         left("C'") + ", C+ " + left("C+") + ". " + kept_text(record);
}

void add_tracking(report::Page& page, const Conditions& conditions,
                  const std::vector<report::Drawing>& drawings) {
  page.section("Does the hand track better?");
  page.figure(drawings.at(0));
  page.table(measures_table(conditions));
  page.table(restoration_table(conditions));
  page.paragraph(
      "C' runs the paper's model, and the canceller adapts the gain and the phase. C+ adapts them "
      "too. The step from C to C' shows what adapting does; the step from C' to C+ shows what the "
      "model of the effect does. Forces, the hand's acceleration and the cancelled share come from "
      "the rig's own truth, which no diagnosis reads.");
}

void add_verdict(report::Page& page, const LoopResult& result,
                 const std::vector<report::Drawing>& drawings) {
  const Verdict& verdict = result.verdict();
  page.section("What the model lacked");
  if (verdict.strongest() == nullptr) {
    page.paragraph(without_effect(verdict, verdict.body.options.least_force_n));
  }
  std::vector<std::string> findings;
  for (const Finding& each : verdict.findings) {
    findings.push_back(each.kind + (each.channel.empty() ? "" : " (" + each.channel + ")") +
                       " in the " + each.where + ", " + report::short_number(each.explained_n) +
                       " N RMS" + (each.counts ? ": " : ", too small to count: ") + each.evidence +
                       ".");
  }
  if (!findings.empty()) page.list(findings);
  page.table(prediction_table(verdict));
  page.figure(drawings.at(1));
  if (!verdict.control.treatments.empty()) {
    const Round& round = result.rounds[result.final_round];
    page.table(treatment_table(verdict.control, round.augmented));
  }
  if (verdict.latency) {
    page.paragraph("The force follows the motor's command after " +
                   number(1e3 * verdict.latency->motor_s, 1) +
                   " ms, and the load cell's reading follows the force after " +
                   number(1e3 * verdict.latency->cell_s, 1) +
                   " ms. Both come from the stick's equation of motion. The canceller predicts "
                   "ahead by the delay of the motor.");
  }
}

void add_repairs(report::Page& page, const LoopRecord& record,
                 const std::vector<report::Drawing>& drawings) {
  if (record.repairs.effects.empty()) return;
  page.section("Mend, cancel or leave");
  page.table(repair_table(record.repairs));
  if (drawings.size() > kRepairDrawing) page.figure(drawings.at(kRepairDrawing));
  page.paragraph(
      "Left: as in C'. Cancelled: by C+. Mended: the effect is gone, and the model of C' is "
      "identified again. " +
      repair_check(record.repairs));
}

void add_truth(report::Page& page, const LoopRecord& record) {
  if (!record.truth) return;
  const Truth& truth = *record.truth;
  page.section("The sealed truth");
  page.paragraph("Opened after the verdict: " + truth.kind +
                 (truth.place.empty() ? "" : ", " + truth.place) +
                 (truth.numbers.empty() ? "" : " (" + truth.numbers + ")") + ". The verdict is " +
                 (record.right() ? "right." : "wrong."));
}

}  // namespace

report::Table measures_table(const Conditions& conditions) {
  report::Table table;
  table.caption = "Means over the repeats, and the paired differences with their 95 % intervals";
  table.header = {""};
  for (const char* label : kConditions) table.header.emplace_back(label);
  table.header.insert(table.header.end(), {"C′ − C", "C+ − C′"});
  for (const Number& shown : session::numbers(session::kLoop)) {
    std::vector<Cell> row{shown.title};
    for (const char* label : kConditions) {
      row.emplace_back(has(label, shown)
                           ? number(measured(conditions, label, shown).mean, shown.decimals + 1)
                           : "");
    }
    for (const auto& [from, to] : kSteps) {
      row.emplace_back(with_interval(change(conditions, from, to, shown), shown.decimals + 1));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

report::Table restoration_table(const Conditions& conditions) {
  report::Table table;
  table.caption = "Share of A's advantage that a condition restores: (B − X)/(B − A)";
  table.header = {"", "C", "C'", "C+", "paper's C"};
  for (const Number& metric : session::kMetrics) {
    std::vector<Cell> row{metric.title};
    for (const char* label : kCancelling) {
      row.emplace_back(percent(restored(conditions, label, metric)));
    }
    row.emplace_back(number(metric.paper->restored_percent, 0) + " %");
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::optional<report::Table> causes_table(const LoopResult& result) {
  report::Table table{
      "RMS of the feedthrough force that is left [N], by its causes, which add up to it; in "
      "brackets 95 %. One trial each.",
      {""}};
  for (const session::ForceCause& cause : session::kForceCauses) {
    table.rows.push_back({cause.meaning});
  }
  table.rows.push_back({"all"});
  const auto add = [&table](std::size_t row, const session::ForceEstimate& each) {
    table.rows[row].emplace_back(number(each.force_n, 2) + " (" + number(each.low_n, 2) + " to " +
                                 number(each.high_n, 2) + ")");
  };
  for (const TrialRun* trial : cancelling_trials(result)) {
    if (!trial->budget) return {};
    table.header.emplace_back(trial->label);
    for (std::size_t i = 0; i < session::kForceCauses.size(); ++i) {
      add(i, (*trial->budget).*session::kForceCauses[i].of);
    }
    add(session::kForceCauses.size(), trial->budget->left);
  }
  return table;
}

report::Table treatment_table(const ConvertedModel& control, bool used) {
  report::Table table;
  table.caption = "What the canceller does about each effect";
  table.header = {"effect", "cancelled", "how"};
  table.align = {report::Align::kLeft, report::Align::kLeft, report::Align::kLeft};
  for (const Treatment& each : control.treatments) {
    table.rows.push_back(
        {each.kind,
         each.cancelled && used ? Cell("yes", Emphasis::kGood) : Cell("no", Emphasis::kFaint),
         used ? each.how : "C+ ran without it: the augmented model was not used"});
  }
  return table;
}

report::Page loop_page(const LoopRecord& record, const std::vector<report::Drawing>& drawings) {
  const LoopResult& result = record.result;
  report::Page page("Closing the loop", lead(record));
  page.banner(report::kSimulatedBanner);
  page.facts(
      {{"command", record.command_line},
       {"seed", std::to_string(record.options.protocol.seed)},
       {"subject", record.subject == 0 ? "the rig's default" : std::to_string(record.subject)},
       {"repeats", std::to_string(record.conditions.at("A").size())},
       {"made by", report::made_by()}});
  add_tracking(page, record.conditions, drawings);
  if (const auto causes = causes_table(result)) page.table(*causes);
  add_verdict(page, result, drawings);
  add_repairs(page, record, drawings);
  page.section("The rounds");
  page.table(rounds_table(result));
  page.figure(drawings.at(2));
  page.figure(drawings.at(3));
  add_truth(page, record);
  return page;
}

}  // namespace stillhand::close_the_loop
