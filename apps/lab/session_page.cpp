// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/session_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "apps/lab/output_folder.hpp"
#include "apps/lab/summary_json.hpp"
#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/report/provenance.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "apps/libraries/session/core/trial_numbers.hpp"
#include "apps/libraries/session/force_budget_table.hpp"

namespace stillhand::lab {
namespace {

using report::number;

std::string restored(std::optional<double> share) {
  return share && std::isfinite(*share) ? report::restored(*share) : "–";
}

std::string restored(const session::SessionResult& result, const session::Number& shown) {
  const session::TrialResult* a = trial_of(result, session::Condition::kA);
  const session::TrialResult* b = trial_of(result, session::Condition::kB);
  if (a != nullptr && b != nullptr && !shown.worse(shown.of(*a), shown.of(*b))) {
    return report::kNotWorse;
  }
  return restored(restoration_of(result, shown));
}

std::vector<report::Cell> own_row(const session::SessionResult& result,
                                  const session::Number& shown) {
  std::vector<report::Cell> row{std::string(shown.title) + ", this session"};
  for (const auto label : session::kPaperConditions) {
    const session::TrialResult* trial = trial_of(result, label);
    const bool disturbed = std::ranges::any_of(
        result.disturbances, [&](const auto& each) { return each.label == label; });
    row.emplace_back(
        number(trial ? shown.of(*trial) : NAN, shown.decimals + 1) + (disturbed ? " *" : ""),
        report::Emphasis::kStrong);
  }
  row.emplace_back(restored(result, shown), report::Emphasis::kStrong);
  return row;
}

std::vector<report::Cell> paper_row(const session::Paper& paper) {
  std::vector<report::Cell> row{"paper, mean of 12"};
  for (const double mean : paper.means()) row.emplace_back(number(mean, 2));
  row.emplace_back(fmt::format("{:.0f} %", paper.restored_percent));
  return row;
}

void add_budgets(const session::SessionResult& result, report::Page& page) {
  for (const session::TrialResult& trial : result.trials) {
    if (!trial.budget) continue;
    page.section("What is left");
    page.table(session::budget_table(name_in(result, trial), *trial.budget));
  }
}

// Which trial ran which model, after the loop was closed in a pause.
void add_closing(const std::vector<session::TrialOutcome>& outcomes,
                 const session::SessionResult& result, report::Page& page) {
  const auto identifies = [](const session::TrialOutcome& outcome) {
    return outcome.completed && outcome.planned.label == session::Condition::kIdentification;
  };
  if (std::ranges::count_if(outcomes, identifies) < 2) return;
  std::string models;
  for (const session::TrialResult& trial : result.trials) {
    if (!session::cancels(trial.label) || !trial.models.force) continue;
    models += fmt::format("{}trial {} ({}) ran model {}", models.empty() ? "" : ", ", trial.number,
                          session::name_of(trial.label), *trial.models.force);
  }
  page.paragraph(fmt::format(
      "The model of C was identified again during the session: {}. {}/report.html has the "
      "diagnosis of the repetition, if it was ready.",
      models, kClosingFolder));
}

}  // namespace

report::Table metrics_table(const session::SessionResult& result) {
  report::Table table{
      "This session and the paper (Gillespie and Sövényi, Tables I and II). The paper's RMS error "
      "has "
      "no unit; one of its units is taken as 5.5 mm. One trial of a condition has no interval.",
      {"", "A", "B", "C", "restored (B - C)/(B - A)"}};
  for (const session::Number& shown : session::samples()) {
    table.rows.push_back(own_row(result, shown));
    if (shown.paper != nullptr) table.rows.push_back(paper_row(*shown.paper));
  }
  return table;
}

report::Table mitigations_table(const session::SessionResult& result) {
  std::vector<const session::TrialResult*> trials = mitigated_trials(result);
  if (const session::TrialResult* c = trial_of(result, session::Condition::kC))
    trials.insert(trials.begin(), c);
  report::Table table{
      "Every mitigation, judged by the error after the first third of its trial, as in the study's "
      "table of mitigations.",
      {"", "RMS error [mm]", "restored (B - it)/(B - A)", "motor [N]", "hand [N]"}};
  for (const session::TrialResult* trial : trials) {
    table.rows.push_back({session::name_of(trial->label), number(trial->settled_rms_error_mm, 1),
                          restored(settled_restoration_of(result, trial->label)),
                          number(trial->forces.motor_n, 2), number(trial->forces.volitional_n, 2)});
  }
  return table;
}

report::Page session_page(const LabOptions& options,
                          const std::vector<session::TrialOutcome>& outcomes,
                          const session::SessionResult& result,
                          const std::vector<report::Drawing>& drawings) {
  report::Page page("One session",
                    "A: the platform stands. B: it moves. C: it moves, and the motor cancels what "
                    "the body passes on to the stick.");
  if (simulated_subject(options)) page.banner(report::kSimulatedBanner);
  for (const std::string& line : uncounted_lines(outcomes)) page.warning(line + ".");
  page.facts({{"made by", report::made_by()},
              {"seed", fmt::to_string(options.protocol.seed)},
              {"trial", report::short_number(options.protocol.trial_s) + " s"},
              {"command line", report::command_line()}});
  if (!result.rig_parts.empty()) page.paragraph("The " + result.rig_parts + ".");
  page.section("Tracking metrics");
  page.table(metrics_table(result));
  std::string meanings;
  for (const session::Number& shown : session::samples()) {
    meanings += fmt::format("{}: {}. ", shown.title, shown.meaning);
  }
  page.paragraph(meanings + "Another session gives other numbers.");
  for (const std::string& line : disturbance_lines(result)) page.paragraph("* " + line + ".");
  for (const std::string& line : model_change_lines(outcomes)) page.warning(line + ".");
  add_closing(outcomes, result, page);
  add_budgets(result, page);
  if (!mitigated_trials(result).empty()) {
    page.section("Mitigations");
    page.table(mitigations_table(result));
  }
  if (drawings.empty()) return page;
  page.section("Traces");
  for (const report::Drawing& drawing : drawings) page.figure(drawing);
  return page;
}

}  // namespace stillhand::lab
