// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/output.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/report/or_null.hpp"
#include "apps/report/text.hpp"
#include "apps/session/paper_table.hpp"
#include "services/rig/sealed_file.hpp"
#include "version.hpp"

namespace stillhand::close_the_loop {
namespace {

using nlohmann::ordered_json;
using report::or_null;
using session::kMetrics;

ordered_json condition_json(const TrialRun& trial) {
  ordered_json condition;
  for (const session::Metric& metric : kMetrics) {
    const double value = metric.of(trial.metrics);
    condition[metric.key] = {{"mean", or_null(value)},
                             {"std", nullptr},
                             {"per_subject", ordered_json::array({or_null(value)})}};
  }
  condition["crossover_reference_hz"] = or_null(trial.metrics.crossover_reference_hz);
  const bool cancels = trial.label.front() == 'C';
  condition["cancelled_share"] = cancels ? or_null(trial.cancelled_share) : ordered_json(nullptr);
  if (cancels) condition["counterforce_delay_ms"] = or_null(1e3 * trial.counterforce_delay_s);
  return condition;
}

ordered_json restoration_json(const LoopResult& result, const TrialRun& of) {
  ordered_json json;
  for (std::size_t k = 0; k < kMetrics.size(); ++k) {
    json[kMetrics[k].restoration_key] = or_null(restoration(result, of, k));
  }
  return json;
}

ordered_json finding_json(const Finding& finding) {
  return {{"kind", finding.kind},
          {"channel", or_null(finding.channel)},
          {"where", finding.where},
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

ordered_json round_json(const Round& round) {
  ordered_json treatments = ordered_json::array();
  for (const Treatment& each : round.verdict.control.treatments) {
    treatments.push_back({{"kind", each.kind},
                          {"cancelled", each.cancelled && round.augmented},
                          {"how", round.augmented ? each.how : round.outcome}});
  }
  ordered_json json{{"findings", findings_json(round.verdict)},
                    {"treatments", treatments},
                    {"conversion_error", round.verdict.control.conversion_error},
                    {"latency", latency_json(round.verdict.latency)},
                    {"augmented", round.augmented},
                    {"kept", round.kept},
                    {"outcome", round.outcome},
                    {"rms_error_mm", or_null(round.trial.metrics.rms_error_mm)},
                    {"weights", nullptr}};
  if (!round.trial.weights.empty()) json["weights"] = round.trial.weights.back();
  return json;
}

}  // namespace

Truth truth_of(const std::string& sealed_text) {
  const auto json = nlohmann::json::parse(sealed_text);
  Truth truth;
  truth.kind = json.at("kind");
  if (json.at("channel").is_string()) truth.channel = json.at("channel");
  truth.place = json.at("place");
  for (const auto& [name, value] : json.at("parameters").items()) {
    const std::string unit = value.at("unit");
    truth.numbers += (truth.numbers.empty() ? "" : ", ") + name + " " +
                     report::short_number(value.at("value")) + (unit == "-" ? "" : " " + unit);
  }
  return truth;
}

double restoration(const LoopResult& result, const TrialRun& of, std::size_t metric) {
  const auto value = [&](const TrialRun& trial) { return kMetrics[metric].of(trial.metrics); };
  const double moving = value(result.trial("B"));
  return (moving - value(of)) / (moving - value(result.trial("A")));
}

std::string verdict_json(const LoopResult& result) {
  const Verdict& verdict = result.verdict();
  ordered_json json{{"kind", verdict.kind()}, {"channel", nullptr}};
  if (!verdict.findings.empty() && !verdict.findings.front().channel.empty()) {
    json["channel"] = verdict.findings.front().channel;
  }
  json["findings"] = findings_json(verdict);
  return json.dump(2) + "\n";
}

std::string summary_json(const LoopRecord& record) {
  const LoopResult& result = record.result;
  ordered_json summary;
  for (const char* label : {"A", "B", "C"}) {
    summary["conditions"][label] = condition_json(result.trial(label));
  }
  summary["conditions"]["C+"] = condition_json(result.plus());
  summary["t_tests"] = nullptr;
  summary["manova"] = nullptr;
  summary["restoration"] = restoration_json(result, result.trial("C"));
  summary["restoration_c_plus"] = restoration_json(result, result.plus());
  summary["verdict"] = ordered_json::parse(verdict_json(result));
  summary["force_prediction"] = prediction_json(result.verdict());
  summary["rounds"] = ordered_json::array();
  for (const Round& round : result.rounds) summary["rounds"].push_back(round_json(round));
  summary["truth"] = nullptr;
  if (record.truth) {
    summary["truth"] = {{"kind", record.truth->kind},
                        {"channel", or_null(record.truth->channel)},
                        {"place", record.truth->place},
                        {"verdict_right", record.right()}};
  }
  summary["identification"] = {
      {"order", result.paper_model.fit.order()},
      {"heldout_vaf_percent", or_null(result.paper_model.heldout.free_run_vaf_percent)},
      {"conversion_error", or_null(result.paper_model.conversion_error)}};
  const session::ProtocolOptions& protocol = record.options.protocol;
  summary["live"] = record.live;
  summary["seed"] = protocol.seed;
  summary["undeclared_effect_seed"] = record.undeclared_effect;
  summary["trial_seconds"] = protocol.trial_s;
  summary["identify_seconds"] = protocol.identify_s;
  summary["version"] = kVersion;
  return summary.dump(2) + "\n";
}

void print_result(const LoopRecord& record) {
  const LoopResult& result = record.result;
  std::printf("\n%-20s %8s %8s %8s %8s   %10s %10s   %s\n", "", "A", "B", "C", "C+", "C restores",
              "C+ restores", "paper's C");
  for (std::size_t k = 0; k < kMetrics.size(); ++k) {
    const session::Metric& metric = kMetrics[k];
    std::printf("%-20s", metric.title);
    for (const char* label : {"A", "B", "C"}) {
      std::printf(" %8.3f", metric.of(result.trial(label).metrics));
    }
    std::printf(" %8.3f   %8.0f %% %9.0f %%   %.0f %%\n", metric.of(result.plus().metrics),
                100.0 * restoration(result, result.trial("C"), k),
                100.0 * restoration(result, result.plus(), k), metric.paper_restored_percent);
  }
  std::printf("feedthrough force cancelled: C %.1f %%, C+ %.1f %%\n",
              100.0 * result.trial("C").cancelled_share, 100.0 * result.plus().cancelled_share);
  std::printf("delay of the motor's counterforce: C %.1f ms, C+ %.1f ms\n",
              1e3 * result.trial("C").counterforce_delay_s,
              1e3 * result.plus().counterforce_delay_s);
  const Verdict& verdict = result.verdict();
  if (verdict.findings.empty()) std::printf("the model lacks nothing that moves a hand\n");
  for (const Finding& finding : verdict.findings) {
    std::printf("missing: %s%s%s%s in the %s, %.2f N: %s\n", finding.kind.c_str(),
                finding.channel.empty() ? "" : " (", finding.channel.c_str(),
                finding.channel.empty() ? "" : ")", finding.where.c_str(), finding.explained_n,
                finding.evidence.c_str());
  }
  std::printf(
      "prediction of the pegged force, held out: %.4f N before, %.4f N after, noise %.4f N\n",
      verdict.body.baseline_error.rmse, verdict.body.final_error.rmse,
      verdict.body.noise_floor.rmse);
  for (const Round& round : result.rounds) std::printf("C+: %s\n", round.outcome.c_str());
  if (record.truth) {
    std::printf("the sealed truth: %s%s%s; the verdict is %s\n", record.truth->kind.c_str(),
                record.truth->place.empty() ? "" : ", ", record.truth->place.c_str(),
                record.right() ? "right" : "wrong");
  }
}

std::vector<std::string> every_name() {
  std::vector<std::string> names{"report.html",       "summary.json",    kVerdictFile,
                                 "model.json",        kControlModelFile, rig::kSealedFile,
                                 rig::kCommitmentFile};
  for (const char* figure : {"tracking", "force", "adaptation", "motion"}) {
    for (const char* ending : {".svg", ".png"}) names.push_back(std::string(figure) + ending);
  }
  return names;
}

}  // namespace stillhand::close_the_loop
