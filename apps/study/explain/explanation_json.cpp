// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "apps/study/explain/explanation_output.hpp"
#include "version.hpp"

namespace stillhand::study {
namespace {

using nlohmann::ordered_json;

ordered_json z_json(const TableVector& z) {
  ordered_json out = ordered_json::object();
  for (Eigen::Index i = 0; i < kTableFigures; ++i) {
    out[table_figure_names()[static_cast<std::size_t>(i)]] = z[i];
  }
  return out;
}

ordered_json hypothesis_json(const Hypothesis& one) {
  ordered_json parameters = ordered_json::object();
  for (const Marginal& marginal : one.parameters) {
    parameters[marginal.name] = {{"median", marginal.median},
                                 {"ci95", {marginal.low, marginal.high}}};
  }
  ordered_json calibrated_again = ordered_json::object();
  for (std::size_t i = 0; i < one.shift.size(); ++i) {
    calibrated_again[calibrated()[i].name] = std::exp(one.shift[i]);
  }
  return {{"name", one.name},
          {"parameters", parameters},
          {"log_evidence", one.log_evidence},
          {"log_evidence_error", one.log_evidence_error},
          {"fit_p", one.fit_p},
          {"calibrated_factors", calibrated_again},
          {"z", z_json(one.z)}};
}

ordered_json judged_json(const Judged& one) {
  ordered_json measured = ordered_json::object();
  for (const Observable& observable : observables()) {
    double sum = 0.0;
    for (const Response& subject : one.subjects) sum += subject.observed.*observable.value;
    measured[observable.name] = observable.scale * sum / static_cast<double>(one.subjects.size());
  }
  return {{"name", one.name},
          {"log_score", one.log_score},
          {"z", z_json(one.z)},
          {"restoration",
           {{"rms_error", one.restored[0]},
            {"dwell_ratio", one.restored[1]},
            {"crossover", one.restored[2]}}},
          {"measurable", measured}};
}

ordered_json spread_fit_json(const SpreadFit& one) {
  ordered_json causes = ordered_json::object();
  for (const auto& [c, value] : one.causes) causes[spread_causes()[c].name] = value;
  return {{"name", one.name},
          {"causes", causes},
          {"given", one.given},
          {"given_ci95", {one.low, one.high}},
          {"means_hold", one.holds},
          {"sd_over_paper", one.over_paper},
          {"z_of_c", one.z_of_c},
          {"z", z_json(one.z)},
          {"log_likelihood", one.log_likelihood}};
}

ordered_json spread_json(const Spread& spread) {
  const auto all = [](const std::vector<SpreadFit>& fits) {
    ordered_json out = ordered_json::array();
    for (const SpreadFit& one : fits) out.push_back(spread_fit_json(one));
    return out;
  };
  ordered_json judged = ordered_json::array();
  for (const SpreadJudged& one : spread.judged) {
    ordered_json row = spread_fit_json(one.fit);
    row["sd_over_paper_ci95"] = one.ratio_ci95;
    for (std::size_t s = 0; s < kSignatures.size(); ++s) {
      row["signatures"][kSignatures[s].name] = one.signatures[s];
    }
    judged.push_back(std::move(row));
  }
  return {{"subjects", spread.subjects},
          {"seed", spread.seed},
          {"judged_seed", spread.judged_seed},
          {"paper_sd", spread.paper},
          {"chain", spread_fit_json(spread.chain)},
          {"causes", all(spread.ranked)},
          {"at_the_end", all(spread.ends)},
          {"combination", spread_fit_json(spread.combination)},
          {"judged", judged}};
}

void add_means(const Explanation& explanation, ordered_json& out) {
  out["causes"] = ordered_json::array();
  out["pairs"] = ordered_json::array();
  for (const Hypothesis& one : explanation.single) out["causes"].push_back(hypothesis_json(one));
  for (const Hypothesis& one : explanation.pairs) out["pairs"].push_back(hypothesis_json(one));
  out["paper_chain_z"] = z_json(explanation.judged[1].z);
  out["indistinguishable"] = ordered_json::array();
  for (const auto& among : {explanation.single, explanation.all()}) {
    const auto names = indistinguishable(among);
    if (!names.empty()) out["indistinguishable"].push_back(names);
  }
  out["judged"] = ordered_json::array();
  for (const Judged& one : explanation.judged) out["judged"].push_back(judged_json(one));
  out["compensated"] =
      explanation.compensated ? judged_json(*explanation.compensated) : ordered_json(nullptr);
  out["units"] = ordered_json::array();
  for (const UnitSensitivity& one : explanation.units) {
    out["units"].push_back({{"unit_mm", one.unit_mm},
                            {"best_single", one.best_single},
                            {"best_pair", one.best_pair},
                            {"paper_chain_log_bayes_factor", one.paper_chain},
                            {"best_pair_log_bayes_factor", one.best_pair_gain}});
  }
}

}  // namespace

std::string explanation_json(const Explanation& explanation) {
  ordered_json out;
  out["version"] = kVersion;
  out["seed"] = explanation.options.seed;
  out["subjects"] = explanation.options.subjects;
  out["unit_mm"] = explanation.options.unit_mm;
  if (!explanation.single.empty()) add_means(explanation, out);
  if (explanation.spread) out["spread"] = spread_json(*explanation.spread);
  out["wall_s"] = explanation.wall_s;
  return out.dump(2) + "\n";
}

}  // namespace stillhand::study
