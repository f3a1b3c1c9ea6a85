// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/broken_tie.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/working_set.hpp"
#include "services/core/identification/record.hpp"

namespace stillhand::diagnose {
namespace {

diagnosis::Measurement at_rate(const diagnosis::Measurement& measurement, double rate_hz) {
  const std::size_t factor = diagnosis::rate_factor(measurement, rate_hz);
  return factor == 1 ? measurement : diagnosis::decimated(measurement, factor);
}

std::vector<std::string> names_of(const BrokenTie& tie, const std::vector<Eigen::Index>& which) {
  std::vector<std::string> names;
  for (const Eigen::Index i : which) {
    names.push_back(next_run::name_of(tie.candidates[static_cast<std::size_t>(i)]));
  }
  return names;
}

// Candidates that all fail differ in how they fail, with much evidence: another person,
// another rig, a unit or a sign that changed.
void check_explained(const next_run::Contest& contest, const diagnosis::Measurement& run) {
  constexpr double kLeast_percent = 50.0;
  const std::vector<double>& output = run.find(contest.candidates().front().model.output)->values;
  double best_percent = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < contest.candidates().size(); ++i) {
    best_percent =
        std::max(best_percent, identification::vaf_percent(output, contest.prediction(i, run)));
  }
  if (best_percent >= kLeast_percent) return;
  throw ConfigError("--plan",
                    fmt::format("a run of which no candidate explains half (at best {:.0f} % of "
                                "the variance)",
                                best_percent),
                    "the run of the plan, of the same rig and person, in the same units");
}

void check_length(const next_run::PlanFile& plan, const diagnosis::Measurement& run) {
  const double length_s = static_cast<double>(run.size()) / run.rate_hz;
  if (length_s >= 0.5 * plan.seconds) return;
  throw ConfigError("--plan", fmt::format("a run of {:.3g} s", length_s),
                    fmt::format("most of the {:.3g} s that were planned", plan.seconds));
}

// Of those that no other one beats, the one with the most evidence against the first.
Eigen::Index leader_of(const next_run::Evidence& evidence) {
  return std::ranges::max(evidence.left(), {},
                          [&](Eigen::Index i) { return evidence.twice_log_ratio(i, 0); });
}

}  // namespace

BrokenTie broken_tie(const next_run::PlanFile& plan, const diagnosis::Measurement& before,
                     const diagnosis::Measurement& run) {
  const diagnosis::Model& model = plan.candidates.front().model;
  const diagnosis::Signals signals(at_rate(before, model.rate_hz), model.inputs, model.output);
  const next_run::Contest contest(plan.candidates, signals);
  const diagnosis::Measurement made = at_rate(run, model.rate_hz);
  check_length(plan, made);
  BrokenTie tie{contest.candidates(), contest.before(), contest.with(made)};
  check_explained(contest, made);
  return tie;
}

std::string tie_table(const BrokenTie& tie) {
  const auto left = tie.after.left();
  std::string text = fmt::format("tie     {}: {}\n", left.size() == 1 ? "broken, left is" : "left",
                                 fmt::join(names_of(tie, left), " and "));
  const Eigen::Index leader = leader_of(tie.after);
  for (Eigen::Index j = 0; j < tie.after.twice_log_ratio.cols(); ++j) {
    if (j == leader) continue;
    text += fmt::format(
        "        against {}: twice the log likelihood ratio {:.1f} +- {:.1f} (before: {:.1f} +- "
        "{:.1f})\n",
        next_run::name_of(tie.candidates[static_cast<std::size_t>(j)]),
        tie.after.twice_log_ratio(leader, j), tie.after.standard_error(leader, j),
        tie.before.twice_log_ratio(leader, j), tie.before.standard_error(leader, j));
  }
  return text;
}

std::string with_tie(const std::string& json, const BrokenTie& tie) {
  auto verdict = nlohmann::ordered_json::parse(json);
  const auto left = tie.after.left();
  const Eigen::Index leader = leader_of(tie.after);
  auto& entry = verdict["tie"];
  entry = {{"broken", left.size() == 1}, {"left", names_of(tie, left)}};
  entry["evidence"] = nlohmann::ordered_json::array();
  for (Eigen::Index j = 0; j < tie.after.twice_log_ratio.cols(); ++j) {
    if (j == leader) continue;
    entry["evidence"].push_back(
        {{"against", next_run::name_of(tie.candidates[static_cast<std::size_t>(j)])},
         {"twice_log_ratio", tie.after.twice_log_ratio(leader, j)},
         {"standard_error", tie.after.standard_error(leader, j)}});
  }
  return verdict.dump(2) + "\n";
}

}  // namespace stillhand::diagnose
