// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/broken_tie.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "services/core/diagnosis/working_set.hpp"

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
  return {contest.candidates(), contest.before(), contest.with(at_rate(run, model.rate_hz))};
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
