// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/pause_verdict.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/libraries/report/text/text.hpp"

namespace stillhand::lab {
namespace {

using Json = nlohmann::json;

std::string newton(const Json& level) { return report::number(level.at("rms"), 2) + " N"; }

double unseen_s(const Json& summary) {
  double seconds = 0.0;
  for (const Json& record : summary.at("unseen")) seconds += record.at("seconds").get<double>();
  return seconds;
}

// The effects that are in C+; what the verdict names besides is left alone.
std::string carried(const Json& summary) {
  std::string out;
  for (const Json& each : summary.at("treatments")) {
    if (!each.at("cancelled").get<bool>()) continue;
    out += (out.empty() ? "" : " and ") + each.at("kind").get<std::string>();
  }
  return out;
}

std::string why_not(const Json& summary) {
  if (summary.at("verdict").at("kind") == "none") return "nothing that counts is missing in it";
  const std::string kind = carried(summary);
  if (kind.empty()) {
    const Json& left = summary.at("treatments").at(0);
    return left.at("kind").get<std::string>() +
           " is left alone: " + left.at("how").get<std::string>();
  }
  if (const Json& refused = summary.at("not_carried"); !refused.is_null()) {
    return kind + " is not carried: " + refused.get<std::string>();
  }
  if (summary.at("decided_on") != "motor") return kind + " was not judged by the motor";
  if (summary.at("kept").get<bool>()) return {};
  const Json& decision = summary.at("decision");
  return fmt::format("C+ ({}) would leave {} where it leaves {}{}", kind,
                     newton(decision.at("augmented")), newton(decision.at("linear")),
                     decision.at("less").get<double>() > 0.0 ? ", which may be chance" : "");
}

}  // namespace

PauseVerdict pause_verdict(const std::string& text) {
  const Json summary = Json::parse(text);
  PauseVerdict out;
  out.why_not = why_not(summary);
  if (!out.why_not.empty()) return out;
  const Json& decision = summary.at("decision");
  out.certain = !decision.at("less_interval95").is_null();
  out.found =
      fmt::format("{}: leaves {} where a linear model leaves {}, in {:.0f} s that no fit has seen",
                  carried(summary), newton(decision.at("augmented")), newton(decision.at("linear")),
                  unseen_s(summary));
  return out;
}

}  // namespace stillhand::lab
