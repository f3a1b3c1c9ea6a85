// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/libraries/report/or_null.hpp"
#include "apps/libraries/session/numbers_json.hpp"
#include "apps/study/report/diagnoses_output.hpp"
#include "apps/study/report/output.hpp"
#include "version.hpp"

namespace stillhand::study {
namespace {

using nlohmann::ordered_json;
using report::or_null;
using session::kMetrics;
using session::Number;
using session::of_each_metric;

ordered_json sample_json(const MetricSample& sample) {
  ordered_json each = ordered_json::array();
  for (const double value : sample.per_subject) each.push_back(value);
  return {
      {"mean", sample.mean}, {"std", or_null(sample.standard_deviation)}, {"per_subject", each}};
}

ordered_json conditions_json(const Analysis& analysis) {
  ordered_json out = ordered_json::object();
  for (const auto& [condition, metrics] : analysis.conditions) {
    ordered_json& one = out[name_of(condition)];
    for (std::size_t k = 0; k < metrics.size(); ++k) {
      const session::Number& number = session::kNumbers[k];
      if (gives(condition, number)) one[number.key] = sample_json(metrics[k]);
    }
  }
  return out;
}

std::string name_of(const Comparison& comparison) {
  return pair_word(comparison.from, comparison.to);
}

ordered_json p_values_json(const Analysis& analysis) {
  ordered_json out = ordered_json::object();
  for (const Comparison& comparison : analysis.comparisons) {
    out[name_of(comparison)] = of_each_metric(&Number::key, [&](std::size_t k) {
      const auto& test = comparison.tests[k];
      return test ? ordered_json(test->p) : ordered_json(nullptr);
    });
  }
  return out;
}

ordered_json t_test_details_json(const Analysis& analysis) {
  ordered_json out = ordered_json::object();
  for (const Comparison& comparison : analysis.comparisons) {
    ordered_json one;
    for (std::size_t k = 0; k < kMetricCount; ++k) {
      const auto& test = comparison.tests[k];
      if (!test) continue;
      one[kMetrics[k].key] = {{"t", test->t},
                              {"degrees_of_freedom", test->degrees_of_freedom},
                              {"mean_difference", test->mean_difference},
                              {"ci95", {test->ci_low, test->ci_high}},
                              {"cohen_dz", test->cohen_dz},
                              {"hedges_gz", or_null(test->hedges_gz)}};
    }
    out[name_of(comparison)] = one;
  }
  return out;
}

ordered_json effect_json(const statistics::MultivariateTest& effect) {
  return {{"wilks_lambda", effect.wilks_lambda},
          {"f", effect.wilks.f},
          {"numerator_df", effect.wilks.numerator_df},
          {"denominator_df", effect.wilks.denominator_df},
          {"p", effect.wilks.p},
          {"pillai_trace", effect.pillai_trace},
          {"pillai_p", effect.pillai.p}};
}

ordered_json manova_json(const MultivariateResult& result, const std::string& design) {
  if (!result.manova) return {{"design", design}, {"reason", result.reason}};
  ordered_json out{{"design", design},
                   {"condition", effect_json(result.manova->condition)},
                   {"subject", effect_json(result.manova->subject)},
                   {"interaction", nullptr}};
  if (result.manova->interaction) out["interaction"] = effect_json(*result.manova->interaction);
  return out;
}

// The tests over more, or other, conditions than the paper's.
void add_all_conditions(const Analysis& analysis, ordered_json& summary) {
  if (!analysis.all_main_effects || !analysis.all_thirds) return;
  const std::string all = words_of_conditions(analysis);
  summary["manova_all"] =
      manova_json(*analysis.all_main_effects, all + ": main effects, one value a cell");
  summary["manova_all_thirds"] = manova_json(
      *analysis.all_thirds, all + ": thirds of a trial as replicates; RMS error and dwell");
}

ordered_json restoration_interval_json(const Restoration& restoration) {
  return of_each_metric(&Number::name,
                        [&](std::size_t k) { return or_null(restoration[k].interval); });
}

ordered_json restoration_json(const Restoration& restoration) {
  return of_each_metric(&Number::name,
                        [&](std::size_t k) { return or_null(restoration[k].share); });
}

// By C; null values where it was not run.
Restoration restoration_of(const Analysis& analysis) {
  const auto found = analysis.restoration.find(kC);
  return found == analysis.restoration.end() ? Restoration{} : found->second;
}

// "restoration_c_prime" and "restoration_c_plus" as in close-the-loop, or "restoration_signal".
std::string restoration_key(Condition condition) {
  if (condition == kCPrime) return "restoration_c_prime";
  if (condition == kCPlus) return "restoration_c_plus";
  std::string word = name_of(condition);
  std::ranges::replace_if(word, [](char c) { return c == '-' || c == '+'; }, '_');
  return "restoration_" + word;
}

// By C', C+ and mitigations, where they were run.
void add_other_restorations(const Analysis& analysis, ordered_json& summary) {
  for (const auto& [condition, restoration] : analysis.restoration) {
    if (condition == kC) continue;
    const std::string key = restoration_key(condition);
    summary[key] = restoration_json(restoration);
    summary[key + "_interval95"] = restoration_interval_json(restoration);
  }
}

ordered_json identification_json(const StudyRecord& record) {
  ordered_json subjects = ordered_json::array();
  for (const SubjectResult& result : record.results) {
    const Identification& found = result.identification;
    subjects.push_back(
        {{"heldout_vaf_percent", found.paper.heldout.free_run_vaf_percent},
         {"refined_heldout_vaf_percent", found.refined.heldout.free_run_vaf_percent},
         {"refined_used", !found.paper_unusable.empty()},
         {"reason", or_null(found.paper_unusable)},
         {"gain_at_0_hz_n_s2_m", std::abs(signal::response_at(found.refined.model, 0.0))}});
  }
  return {{"refined_used", record.analysis.refined_used}, {"subjects", subjects}};
}

ordered_json planned_json(const std::vector<PlannedComparison>& all, double alpha) {
  ordered_json out = ordered_json::object();
  for (const PlannedComparison& planned : all) {
    ordered_json one;
    for (std::size_t k = 0; k < kMetricCount; ++k) {
      const auto& test = planned.comparison.tests[k];
      if (!test) continue;
      one[kMetrics[k].key] = {
          {"p", test->p}, {"p_holm", *planned.p_holm[k]}, {"found", *planned.p_holm[k] < alpha}};
    }
    out[name_of(planned.comparison)] = one;
  }
  return out;
}

ordered_json standing_json(const experiment::Standing& standing) {
  ordered_json out{{"planned", standing.planned()},
                   {"complete", standing.complete},
                   {"excluded", ordered_json::object()},
                   {"incomplete", ordered_json::object()},
                   {"unblinded", ordered_json::array()}};
  for (const auto& [code, why] : standing.excluded) out["excluded"][code] = why;
  for (const auto& [code, state] : standing.incomplete) out["incomplete"][code] = state;
  for (const experiment::Entry& entry : standing.openings) {
    out["unblinded"].push_back({{"time", entry.time},
                                {"participant", or_null(entry.participant)},
                                {"complete", or_null(entry.complete)},
                                {"reason", entry.text}});
  }
  return out;
}

ordered_json registered_json(const Registered& registered) {
  const Registration& registration = registered.registration;
  const auto& rules = registration.rules;
  ordered_json out{{"alpha", registration.alpha},
                   {"comparisons", planned_json(registered.planned, registration.alpha)}};
  ordered_json& numbers = out["exclusion_rules"];
  const auto put = [&](std::string_view name, const auto& value, Range, std::string_view) {
    numbers[std::string(name)] = value;
  };
  experiment::Exclusion::fields(put, rules);
  out["excluded"] = registered.excluded;
  out["standing"] = standing_json(registration.standing);
  const Analysis& without = registered.analysis_without;
  out["without_rules"] = {
      {"participants", registered.without.participants},
      {"conditions", conditions_json(without)},
      {"t_tests", p_values_json(without)},
      {"t_test_details", t_test_details_json(without)},
      {"restoration", restoration_json(restoration_of(without))},
      {"restoration_interval95", restoration_interval_json(restoration_of(without))},
      {"comparisons", planned_json(registered.planned_without, registration.alpha)}};
  return out;
}

ordered_json needed_json(const StudyRecord& record) {
  ordered_json out{{"alpha", alpha_of(record)}, {"participants_needed", ordered_json::array()}};
  for (const Needed& needed : record.needed) {
    ordered_json one{{"comparison", needed.comparison},
                     {"metric", kMetrics[needed.metric].key},
                     {"effect", needed.effect},
                     {"effect_dz", needed.effect_dz},
                     {"at", ordered_json::array()}};
    for (const Needed::At& at : needed.at) {
      one["at"].push_back({{"wanted_power", at.wanted_power},
                           {"participants", at.participants},
                           {"power", at.power}});
    }
    out["participants_needed"].push_back(one);
  }
  return out;
}

ordered_json wrong_json(const Analysis& analysis) {
  ordered_json out = ordered_json::object();
  for (const auto& [which, wrong] : analysis.wrong) {
    ordered_json one =
        of_each_metric(&Number::key, [&](std::size_t k) { return sample_json(wrong.metrics[k]); });
    one["surviving_share"] = ordered_json::array();
    for (const double share : wrong.surviving_share) one["surviving_share"].push_back(share);
    out[which == 'O' ? "other_subject" : "mean_of_others"] = one;
  }
  return out;
}

ordered_json paired_json(const PairedCheck& check) {
  ordered_json out{{"people", check.n},
                   {"mean_difference", nullptr},
                   {"ci95", nullptr},
                   {"t", nullptr},
                   {"p", nullptr},
                   {"p_holm", or_null(check.p_holm)},
                   {"p_signed_rank", nullptr}};
  if (check.n > 0) {
    out["mean_difference"] = check.mean_difference;
    out["p_signed_rank"] = check.p_signed_rank;
  }
  if (check.test) {
    out["ci95"] = {check.test->ci_low, check.test->ci_high};
    out["t"] = check.test->t;
    out["p"] = check.test->p;
  }
  return out;
}

ordered_json simulated_json(const SimulatedSide& simulated) {
  ordered_json out{{"same_people", simulated.same_people},
                   {"seed", simulated.seed},
                   {"subjects", simulated.results.size()},
                   {"participants", simulated.participants},
                   {"failed", ordered_json::object()},
                   {"conditions", conditions_json(simulated.analysis)},
                   {"restoration", restoration_json(restoration_of(simulated.analysis))}};
  for (const auto& [code, why] : simulated.failed) out["failed"][code] = why;
  if (!simulated.same_people) return out;
  out["paired"] = ordered_json::object();
  for (const PairedCheck& check : simulated.paired) {
    out["paired"][name_of(check.condition)][kMetrics[check.metric].key] = paired_json(check);
  }
  out["alpha"] = SimulatedSide::kAlpha;
  out["more_than_chance"] = simulated.more_than_chance();
  return out;
}

}  // namespace

Subjects subjects_of(const StudyRecord& record) {
  if (!record.recorded) return Subjects::kSimulated;
  const RecordedSource& source = *record.recorded;
  const auto made = std::ranges::count_if(source.participants, [&](const std::string& code) {
    return source.simulated.contains(code);
  });
  if (made == 0) return Subjects::kPeople;
  return made == std::ssize(source.participants) ? Subjects::kSimulated : Subjects::kMixed;
}

double alpha_of(const StudyRecord& record) {
  constexpr double kAlpha = 0.05;
  const bool registered = record.recorded && record.recorded->registered;
  return registered ? record.recorded->registered->registration.alpha : kAlpha;
}

std::vector<std::pair<Condition, Condition>> planned_pairs(const StudyRecord& record) {
  const bool registered = record.recorded && record.recorded->registered;
  if (registered) return record.recorded->registered->registration.comparisons;
  return {{kA, kB}, {kB, kC}};
}

std::string summary_json(const StudyRecord& record) {
  const StudyOptions& options = record.options;
  ordered_json summary;
  summary["conditions"] = conditions_json(record.analysis);
  summary["t_tests"] = p_values_json(record.analysis);
  summary["manova"] = manova_json(record.analysis.main_effects, "main effects, one value a cell");
  summary["restoration"] = restoration_json(restoration_of(record.analysis));
  summary["restoration_interval95"] = restoration_interval_json(restoration_of(record.analysis));
  add_other_restorations(record.analysis, summary);
  summary["t_test_details"] = t_test_details_json(record.analysis);
  summary["manova_thirds"] =
      manova_json(record.analysis.thirds, "thirds of a trial as replicates; RMS error and dwell");
  add_all_conditions(record.analysis, summary);
  summary["wrong_models"] = wrong_json(record.analysis);
  summary["identification"] = identification_json(record);
  summary["subjects"] = options.subjects;
  const Subjects who = subjects_of(record);
  summary["operator"] = who == Subjects::kSimulated ? "simulated"
                        : who == Subjects::kMixed   ? "simulated and person"
                                                    : "person";
  summary["seed"] = record.recorded ? ordered_json(nullptr) : ordered_json(options.seed);
  summary["trial_seconds"] = options.protocol.trial_s;
  summary["identify_seconds"] = options.protocol.identify_s;
  summary["canceller"] = record.recorded ? ordered_json(nullptr) : ordered_json(options.canceller);
  if (record.recorded) {
    summary["recorded"] = {{"participants", record.recorded->participants},
                           {"trials", record.recorded->trials.size()},
                           {"left_out", record.recorded->left_out},
                           {"remarks", record.recorded->remarks},
                           {"simulated", record.recorded->simulated},
                           {"digest", or_null(record.recorded->digest)}};
    if (record.recorded->registered) {
      summary["registered"] = registered_json(*record.recorded->registered);
    }
  }
  if (record.plan_dz) summary["plan"] = needed_json(record);
  if (record.simulated) summary["simulated"] = simulated_json(*record.simulated);
  if (record.diagnoses) summary["diagnoses"] = diagnoses_json(*record.diagnoses);
  summary["version"] = kVersion;
  // JSON has no NaN: dump() writes a number that is not finite as null.
  return summary.dump(2) + "\n";
}

}  // namespace stillhand::study
