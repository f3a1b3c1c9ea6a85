// SPDX-License-Identifier: Apache-2.0
#include "services/files/next_run/plan_file.hpp"

#include <nlohmann/json.hpp>

#include "services/core/contract/config_error.hpp"
#include "services/files/diagnosis/model_file.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/files/settings/json_entry.hpp"

namespace stillhand::next_run {
namespace {

constexpr const char* kWanted = "a plan, as `stillhand plan-run` writes it";

Candidate candidate_of(const nlohmann::ordered_json& json, const settings::JsonEntry& entry) {
  Candidate candidate;
  candidate.model = diagnosis::parse_model(json.at("model").dump(), entry.at("model").path());
  candidate.effect = entry.at("effect").count();
  candidate.heldout_rmse = entry.at("heldout_rmse").number();
  if (candidate.effect >= candidate.model.effects.size()) {
    entry.at("effect").refuse("the place of one of the model's effects");
  }
  return candidate;
}

}  // namespace

nlohmann::ordered_json json_of(const Candidate& candidate) {
  const diagnosis::Effect& cause = candidate.cause();
  return {{"kind", cause.kind},
          {"channel", cause.channels.empty() ? nlohmann::ordered_json()
                                             : nlohmann::ordered_json(cause.channels.front())},
          {"form", cause.form},
          {"heldout_rmse", candidate.heldout_rmse},
          {"effect", candidate.effect},
          {"model", nlohmann::ordered_json::parse(diagnosis::model_json(candidate.model))}};
}

PlanFile read_plan(const std::filesystem::path& path) {
  const std::string origin = path.string();
  const auto json = settings::parsed_json(recording::read_file(origin), origin, kWanted);
  if (!json.contains("candidates") || !json.contains("seconds")) {
    throw ConfigError(origin, "a file without candidates", kWanted);
  }
  const settings::JsonEntry top(json, origin);
  PlanFile plan;
  plan.seconds = top.at("seconds").number();
  plan.ride = path.parent_path() / kRideName;
  const auto entries = top.at("candidates").entries(2, kMostCandidates);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    plan.candidates.push_back(candidate_of(json.at("candidates").at(i), entries[i]));
    const auto& [first, next] = std::pair(plan.candidates.front().model, plan.candidates[i].model);
    if (next.inputs != first.inputs || next.output != first.output ||
        next.rate_hz != first.rate_hz) {
      entries[i].at("model").refuse("inputs, output and rate of the first candidate");
    }
  }
  return plan;
}

}  // namespace stillhand::next_run
