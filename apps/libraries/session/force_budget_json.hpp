// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "apps/libraries/report/or_null.hpp"
#include "apps/libraries/session/force_budget.hpp"

namespace stillhand::session {

/// {"left": {"force_n": ..., "interval95": [...]}, "model": ..., ...}; null without a budget.
inline nlohmann::ordered_json budget_json(const std::optional<ForceBudget>& budget) {
  if (!budget) return nullptr;
  const auto estimate = [](const ForceEstimate& each) -> nlohmann::ordered_json {
    return {{"force_n", report::or_null(each.force_n)},
            {"interval95", {report::or_null(each.low_n), report::or_null(each.high_n)}}};
  };
  nlohmann::ordered_json json{{"left", estimate(budget->left)}};
  for (const ForceCause& cause : kForceCauses) json[cause.key] = estimate((*budget).*cause.of);
  return json;
}

}  // namespace stillhand::session
