// SPDX-License-Identifier: Apache-2.0
#include "services/files/next_run/plan_file.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "services/core/contract/config_error.hpp"
#include "services/files/diagnosis/model_file.hpp"
#include "services/files/digest/content_digest.hpp"
#include "services/files/digest/digest.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/files/settings/json_entry.hpp"

namespace stillhand::next_run {
namespace {

constexpr const char* kWanted = "a plan, as `stillhand plan-run` writes it";

void check_text(const settings::JsonEntry& entry, const std::string& expected) {
  const std::string text = entry.is_null() ? std::string() : entry.text();
  if (text != expected) entry.refuse("'" + expected + "'");
}

Candidate candidate_of(const nlohmann::ordered_json& json, const settings::JsonEntry& entry) {
  Candidate candidate;
  candidate.model = diagnosis::parse_model(json.at("model").dump(), entry.at("model").path());
  candidate.effect = entry.at("effect").count();
  candidate.heldout_rmse = entry.at("heldout_rmse").number();
  if (candidate.effect >= candidate.model.effects.size()) {
    entry.at("effect").refuse("the place of one of the model's effects");
  }
  if (candidate.heldout_rmse < 0.0) entry.at("heldout_rmse").refuse("0 or more");
  const diagnosis::Effect& cause = candidate.cause();
  check_text(entry.at("kind"), cause.kind);
  check_text(entry.at("channel"), cause.channels.empty() ? "" : cause.channels.front());
  check_text(entry.at("form"), cause.form);
  return candidate;
}

void check_is_another(const std::vector<Candidate>& candidates, const settings::JsonEntry& newest) {
  const diagnosis::Effect& cause = candidates.back().cause();
  for (std::size_t i = 0; i + 1 < candidates.size(); ++i) {
    const diagnosis::Effect& earlier = candidates[i].cause();
    if (earlier.kind == cause.kind && earlier.channels == cause.channels) {
      newest.at("kind").refuse("another cause than the candidates before it");
    }
  }
}

double seconds_of(const settings::JsonEntry& entry) {
  const double seconds = entry.number();
  if (seconds < kShortest_s || seconds > kLongest_s) {
    entry.refuse(fmt::format("{:g} to {:g} s", kShortest_s, kLongest_s));
  }
  return seconds;
}

// Files without a version are not from `plan-run`.
void check_version(const settings::JsonEntry& top, const std::string& version) {
  const settings::JsonEntry entry = top.at(digest::kProvenance).at("version");
  if (entry.text() != version) {
    entry.refuse("'" + version + "', this program's: plan the run again");
  }
}

std::filesystem::path ride_of(const settings::JsonEntry& top, const std::filesystem::path& folder) {
  check_text(top.at("ride"), kRideName);
  std::filesystem::path ride = folder / kRideName;
  const settings::JsonEntry digest = top.at("ride_sha256");
  if (!std::filesystem::is_regular_file(ride)) {
    throw ConfigError(ride.string(), "no file", "the ride next to its plan");
  }
  if (digest::sha256_of_file(ride) != digest.text()) {
    digest.refuse("the digest of " + ride.string() + ", which is not the ride of this plan");
  }
  return ride;
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

PlanFile read_plan(const std::filesystem::path& path, const std::string& version) {
  const std::string origin = path.string();
  const std::string text = recording::read_file(origin);
  const auto json = settings::parsed_json(text, origin, kWanted);
  if (!json.contains("candidates") || !json.contains("seconds")) {
    throw ConfigError(origin, "a file without candidates", kWanted);
  }
  const settings::JsonEntry top(json, origin);
  PlanFile plan;
  check_version(top, version);
  plan.seconds = seconds_of(top.at("seconds"));
  plan.ride = ride_of(top, path.parent_path());
  const auto entries = top.at("candidates").entries(2, kMostCandidates);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    plan.candidates.push_back(candidate_of(json.at("candidates").at(i), entries[i]));
    const auto& [first, next] = std::pair(plan.candidates.front().model, plan.candidates[i].model);
    if (next.inputs != first.inputs || next.output != first.output ||
        next.rate_hz != first.rate_hz) {
      entries[i].at("model").refuse("inputs, output and rate of the first candidate");
    }
    check_is_another(plan.candidates, entries[i]);
  }
  digest::require_as_written(text, origin);
  return plan;
}

}  // namespace stillhand::next_run
