// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "apps/close_the_loop/repair_output.hpp"
#include "apps/libraries/report/or_null.hpp"
#include "apps/libraries/report/plot/figure_table.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "apps/libraries/session/force_budget_json.hpp"
#include "apps/libraries/session/numbers_json.hpp"
#include "services/files/rig/sealed_file.hpp"
#include "version.hpp"

namespace stillhand::close_the_loop {
namespace {

using nlohmann::ordered_json;
using report::or_null;

ordered_json repeats_json(const Conditions& conditions, const std::string& label,
                          const Number& number) {
  ordered_json list = ordered_json::array();
  for (const TrialRun& run : conditions.at(label)) list.push_back(or_null(number.of(run)));
  return list;
}

// A sample has the shape of a study's summary, with one subject.
ordered_json condition_json(const Conditions& conditions, const std::string& label) {
  ordered_json condition;
  ordered_json intervals;
  for (const Number& number : session::numbers(session::kLoop)) {
    const Estimate value = measured(conditions, label, number);
    ordered_json& out = condition[number.key];
    if (!has(label, number)) {
      if (number.still == session::Still::kLeftOut) condition.erase(number.key);
    } else if (number.shape == session::Shape::kPlain) {
      out = or_null(value.mean);
      intervals[number.key] = or_null(value.interval95);
    } else {
      out["mean"] = or_null(value.mean);
      if (number.shape == session::Shape::kSample) {
        out["std"] = nullptr;
        out["per_subject"] = ordered_json::array({or_null(value.mean)});
      }
      out["interval95"] = or_null(value.interval95);
      out["repeats"] = repeats_json(conditions, label, number);
    }
  }
  condition["interval95"] = intervals;
  return condition;
}

ordered_json restoration_json(const Conditions& conditions, const std::string& label) {
  return session::of_each_metric(&Number::name, [&](std::size_t k) {
    return or_null(restored(conditions, label, kNumbers[k]).mean);
  });
}

ordered_json restoration_intervals_json(const Conditions& conditions) {
  ordered_json json;
  for (const char* label : kCancelling) {
    json[label] = session::of_each_metric(&Number::name, [&](std::size_t k) {
      return or_null(restored(conditions, label, kNumbers[k]).interval95);
    });
  }
  return json;
}

ordered_json change_json(const Estimate& change) {
  return {{"mean_difference", or_null(change.mean)}, {"interval95", or_null(change.interval95)}};
}

// C to C' is what following does, C' to C+ what the effect's model does.
ordered_json changes_json(const Conditions& conditions) {
  ordered_json json;
  for (const auto& [from, to] : kSteps) {
    for (const Number& number : session::numbers(session::kLoop)) {
      json[step_name(from, to)][number.key] = change_json(change(conditions, from, to, number));
    }
  }
  return json;
}

ordered_json finding_json(const Finding& finding) {
  return {{"kind", finding.kind},
          {"channel", or_null(finding.channel)},
          {"where", finding.where},
          {"force_n", {{"value", finding.explained_n}, {"ci95", or_null(finding.interval95)}}},
          {"counts", finding.counts},
          {"explained_rms_n", finding.explained_n},
          {"heldout_rmse_before", finding.before_n},
          {"heldout_rmse_after", finding.after_n},
          {"evidence", finding.evidence}};
}

ordered_json findings_json(const Verdict& verdict) {
  ordered_json list = ordered_json::array();
  for (const Finding& finding : verdict.findings) list.push_back(finding_json(finding));
  return list;
}

// Eq. CL-10.
ordered_json decision_json(const LoopDecision& decision) {
  ordered_json worse = ordered_json::array();
  for (const Harm& harm : decision.harms) {
    worse.push_back({{"measure", harm.number->key},
                     {"than", harm.than},
                     {"mean_difference", harm.rise.mean},
                     {"interval95", or_null(harm.rise.interval95)}});
  }
  return {{"measure", decision.measure->key},
          {"C-C+", change_json(decision.over_c)},
          {"C'-C+", change_json(decision.over_c_prime)},
          {"worse", worse},
          {"model_of", decision.model_of}};
}

ordered_json round_json(const Round& round, bool kept) {
  ordered_json treatments = treatments_json(round.verdict.control);
  if (!round.augmented) {
    for (ordered_json& each : treatments) {
      each["cancelled"] = false;
      each["how"] = round.outcome;
    }
  }
  ordered_json json{{"findings", findings_json(round.verdict)},
                    {"treatments", treatments},
                    {"conversion_error", round.verdict.control.conversion_error},
                    {"latency", latency_json(round.verdict.latency)},
                    {"augmented", round.augmented},
                    {"kept", kept},
                    {"tracks_better", round.better},
                    {"outcome", round.outcome},
                    {"rms_error_mm", or_null(round.trial.metrics.rms_error_mm)},
                    {"weights", nullptr}};
  if (!round.trial.weights.empty()) json["weights"] = round.trial.weights.back();
  return json;
}

std::string harm_text(const LoopDecision& decision) {
  std::string text;
  for (const Harm& harm : decision.harms) {
    text += fmt::format("{}{} by {} than with {}", text.empty() ? " C+ makes worse: " : ", ",
                        harm.number->title, with_interval(harm.rise, harm.number->decimals + 1),
                        harm.than);
  }
  return text.empty() ? text : text + ".";
}

// Eq. CL-10, for what was decided.
const char* reason_text(const LoopDecision& decision) {
  if (!decision.over_c.interval95) return "; one trial has no interval, and the mean decides";
  return decision.kept() ? ", and both intervals are below 0"
                         : ", and not both intervals are below 0";
}

}  // namespace

ordered_json prediction_json(const Verdict& verdict) {
  const diagnosis::Diagnosis& body = verdict.body;
  return {{"before_rmse_n", body.baseline_error.rmse},
          {"before_ci95", {body.baseline_error.low, body.baseline_error.high}},
          {"after_rmse_n", body.final_error.rmse},
          {"after_ci95", {body.final_error.low, body.final_error.high}},
          {"noise_floor_rmse_n", body.noise_floor.rmse},
          {"after_over_noise", body.final_error.rmse / body.noise_floor.rmse}};
}

ordered_json latency_json(const std::optional<Latency>& latency) {
  if (!latency) return nullptr;
  return {{"motor_path_s", latency->motor_s}, {"load_cell_s", latency->cell_s}};
}

ordered_json treatments_json(const ConvertedModel& control) {
  ordered_json list = ordered_json::array();
  for (const Treatment& each : control.treatments) {
    ordered_json difference = nullptr;
    if (each.difference) {
      difference = {{"source", or_null(100.0 * each.difference->source)},
                    {"second", or_null(100.0 * each.difference->second)}};
    }
    list.push_back({{"kind", each.kind},
                    {"channel", or_null(each.channel)},
                    {"cancelled", each.cancelled},
                    {"how", each.how},
                    {"difference_percent", difference}});
  }
  return list;
}

Truth truth_of(const std::string& sealed_text) {
  const auto json = nlohmann::json::parse(sealed_text);
  Truth truth;
  truth.kind = json.at("kind");
  if (json.at("channel").is_string()) truth.channel = json.at("channel");
  truth.place = json.at("place");
  for (const auto& [name, value] : json.at("parameters").items()) {
    const std::string unit = value.at("unit");
    // Of the drive, which is static, there is only the whole force.
    if (name == "force_rms") truth.force_n = value.at("value");
    if (name == "force_beyond_linear") truth.beyond_linear_n = value.at("value");
    truth.numbers += (truth.numbers.empty() ? "" : ", ") + name + " " +
                     report::short_number(value.at("value")) + (unit == "-" ? "" : " " + unit);
  }
  return truth;
}

bool Truth::outside() const {
  return kind != rig::OpenedEffect{}.kind &&
         std::ranges::none_of(diagnosis::effect_kinds(),
                              [&](const auto* each) { return each->name() == kind; });
}

bool Truth::agrees_with(const Verdict& verdict) const {
  if (outside()) {
    const bool small = beyond_linear_n.value_or(force_n) < detectable_n(verdict, place == kDrive);
    const std::string conclusion = verdict.conclusion();
    const bool shape = std::ranges::any_of(diagnosis::effect_kinds(), [&](const auto* each) {
      return each->any_shape() && each->name() == verdict.kind();
    });
    return shape || conclusion == kUnexplained || (small && conclusion == kNothing);
  }
  if (verdict.kind() != kind) return false;
  if (verdict.strongest() == nullptr) return true;
  const Finding& strongest = *verdict.strongest();
  // The rig names a part of the body; a verdict names the body as a whole.
  const bool outside = place == kDrive || place == kMotorPath || place == kLoadCell;
  return strongest.channel == channel && strongest.where == (outside ? place : kBody);
}

std::string verdict_json(const Verdict& verdict) {
  ordered_json json{{"kind", verdict.kind()},
                    {"channel", nullptr},
                    {"where", nullptr},
                    {"conclusion", verdict.conclusion()}};
  if (const Finding* strongest = verdict.strongest()) {
    json["channel"] = or_null(strongest->channel);
    json["where"] = strongest->where;
  }
  json["findings"] = findings_json(verdict);
  return json.dump(2) + "\n";
}

std::string summary_json(const LoopRecord& record) {
  const LoopResult& result = record.result;
  ordered_json summary;
  const Conditions& conditions = record.conditions;
  for (const char* label : kConditions) {
    summary["conditions"][label] = condition_json(conditions, label);
  }
  summary["t_tests"] = nullptr;
  summary["manova"] = nullptr;
  summary["restoration"] = restoration_json(conditions, "C");
  summary["restoration_c_prime"] = restoration_json(conditions, "C'");
  summary["restoration_c_plus"] = restoration_json(conditions, "C+");
  summary["restoration_interval95"] = restoration_intervals_json(conditions);
  summary["paired"] = changes_json(conditions);
  summary["verdict"] = ordered_json::parse(verdict_json(result.verdict()));
  summary["force_prediction"] = prediction_json(result.verdict());
  summary["rounds"] = ordered_json::array();
  for (std::size_t i = 0; i < result.rounds.size(); ++i) {
    const bool kept = record.decision.kept() && i == result.final_round;
    summary["rounds"].push_back(round_json(result.rounds[i], kept));
  }
  for (const TrialRun* trial : cancelling_trials(result)) {
    summary["lateness"][trial->label] = session::budget_json(trial->budget);
  }
  summary["kept"] = record.decision.kept();
  summary["decided_on"] = "motor";
  summary["decision"] = decision_json(record.decision);
  summary["repair"] = repair_json(record.repairs);
  summary["least_force_n"] = result.verdict().body.options.least_force_n;
  summary["truth"] = nullptr;
  if (record.truth) {
    summary["truth"] = {{"kind", record.truth->kind},
                        {"channel", or_null(record.truth->channel)},
                        {"place", record.truth->place},
                        {"verdict_right", record.right()}};
    if (record.truth->outside()) {
      summary["truth"]["force_rms_n"] = record.truth->force_n;
      summary["truth"]["force_beyond_linear_n"] =
          record.truth->beyond_linear_n.value_or(record.truth->force_n);
      summary["truth"]["detectable_n"] =
          detectable_n(result.verdict(), record.truth->place == kDrive);
    }
  }
  summary["identification"] = {
      {"order", result.paper_model.fit.order()},
      {"heldout_vaf_percent", or_null(result.paper_model.heldout.free_run_vaf_percent)},
      {"conversion_error", or_null(result.paper_model.conversion_error)}};
  const session::ProtocolOptions& protocol = record.options.protocol;
  summary["live"] = record.live;
  summary["subject"] = record.subject;
  summary["repeats"] = record.conditions.at("A").size();
  summary["seed"] = protocol.seed;
  summary["undeclared_effect_seed"] = record.undeclared_effect;
  summary["trial_seconds"] = protocol.trial_s;
  summary["identify_seconds"] = protocol.identify_s;
  summary["version"] = kVersion;
  return summary.dump(2) + "\n";
}

std::string without_effect(const Verdict& verdict, double least_force_n) {
  const std::string conclusion = verdict.conclusion();
  if (conclusion == kNoModel)
    return "The acceleration does not explain the force: there is no model.";
  if (conclusion == kUnexplained) {
    return "The residual has a cause that no kind of effect explains.";
  }
  if (least_force_n <= 0.0) return "The model lacks nothing.";
  return "The model lacks nothing of " + report::short_number(least_force_n) +
         " N RMS or more (--least-force).";
}

std::string kept_text(const LoopRecord& record) {
  const LoopDecision& decision = record.decision;
  if (!decision.augmented) return {};
  const int decimals = decision.measure->decimals + 1;
  const std::size_t repeats = record.conditions.at("A").size();
  return fmt::format(
      "C+ is {}: over {} repeat{} that no fit has seen, C+ less C is {} and C+ less C' is {} in "
      "{}{}. "
      "The canceller gets the model of {}.{}",
      decision.kept() ? "kept" : "not kept", repeats, repeats == 1 ? "" : "s",
      with_interval(decision.over_c, decimals), with_interval(decision.over_c_prime, decimals),
      decision.measure->title, reason_text(decision), decision.model_of, harm_text(decision));
}

std::string with_interval(const Estimate& estimate, int decimals, double factor) {
  const auto text = [&](double value) { return report::number(factor * value, decimals); };
  if (!estimate.interval95) return text(estimate.mean);
  const auto& [low, high] = *estimate.interval95;
  return text(estimate.mean) + " [" + text(low) + ", " + text(high) + "]";
}

std::vector<std::string> every_name() {
  std::vector<std::string> names{"report.html",       "summary.json",    kVerdictFile,
                                 "model.json",        kControlModelFile, rig::kSealedFile,
                                 rig::kCommitmentFile};
  for (const char* figure : {"tracking", "force", "adaptation", "motion", "repair", "left"}) {
    for (std::string& name : report::figure_files(figure)) names.push_back(std::move(name));
  }
  return names;
}

}  // namespace stillhand::close_the_loop
