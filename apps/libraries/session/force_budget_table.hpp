// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string>

#include "apps/libraries/report/page.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "apps/libraries/session/force_budget.hpp"

namespace stillhand::session {

/// The causes of what is left, for a page.
/// @param of  a condition or a trial, as "C"
inline report::Table budget_table(const std::string& of, const ForceBudget& budget) {
  report::Table table{
      "What " + of +
          " leaves of the feedthrough force, split into its causes. They add up to the whole; a "
          "cause that cancels another one is negative.",
      {"cause", "[N]", "95 % interval [N]"}};
  const auto add = [&](const std::string& name, const ForceEstimate& each) {
    using report::number;
    table.rows.push_back(
        {name, number(each.force_n, 2), number(each.low_n, 2) + " to " + number(each.high_n, 2)});
  };
  for (const ForceCause& cause : kForceCauses) {
    add(fmt::format("{}: {}", cause.key, cause.meaning), budget.*cause.of);
  }
  add("all: RMS of the body's and the motor's force together", budget.left);
  return table;
}

}  // namespace stillhand::session
