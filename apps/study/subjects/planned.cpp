// SPDX-License-Identifier: Apache-2.0
#include "apps/study/subjects/planned.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "services/core/contract/config_error.hpp"
#include "services/core/statistics/multiple_testing.hpp"
#include "services/core/statistics/power.hpp"

namespace stillhand::study {
namespace {

constexpr double kPowers[]{0.8, 0.9};
// Below it a paired t-test needs more than 80,000 participants: no study has them.
constexpr double kSmallestEffect = 0.01;
constexpr double kLargestEffect = 100.0;  // that the noncentral t is computed for

Needed needed(const std::string& comparison, std::size_t metric, const char* effect, double dz,
              double alpha) {
  Needed out{comparison, metric, effect, dz, {}};
  if (!(std::abs(dz) >= kSmallestEffect)) return out;
  dz = std::clamp(dz, -kLargestEffect, kLargestEffect);
  for (const double wanted : kPowers) {
    const std::size_t n = statistics::subjects_for_power(dz, wanted, alpha);
    out.at.push_back({wanted, n, statistics::paired_t_power(dz, n, alpha)});
  }
  return out;
}

}  // namespace

std::vector<PlannedComparison> planned_comparisons(
    const Analysis& analysis, const std::vector<std::pair<Condition, Condition>>& pairs) {
  std::vector<PlannedComparison> out;
  std::vector<double> p;
  for (const auto& [from, to] : pairs) {
    if (!analysis.conditions.contains(from) || !analysis.conditions.contains(to)) continue;
    out.push_back({compared(analysis, from, to), {}});
    for (const auto& test : out.back().comparison.tests) {
      if (test) p.push_back(test->p);
    }
  }
  if (p.empty()) return out;
  const std::vector<double> adjusted = statistics::holm_adjusted(p);
  auto next = adjusted.begin();
  for (PlannedComparison& planned : out) {
    for (std::size_t k = 0; k < kMetricCount; ++k) {
      if (planned.comparison.tests[k]) planned.p_holm[k] = *next++;
    }
  }
  return out;
}

std::vector<Needed> participants_needed(const Analysis& analysis,
                                        const std::vector<std::pair<Condition, Condition>>& pairs,
                                        const std::vector<double>& given_dz, double alpha) {
  std::vector<Needed> out;
  for (const PlannedComparison& planned : planned_comparisons(analysis, pairs)) {
    const Comparison& comparison = planned.comparison;
    const std::string name = pair_word(comparison.from, comparison.to);
    for (std::size_t k = 0; k < kMetricCount; ++k) {
      const auto& test = comparison.tests[k];
      if (!test) continue;
      const double observed = test->hedges_gz.value_or(test->cohen_dz);
      out.push_back(needed(name, k, "observed", observed, alpha));
      out.push_back(needed(name, k, "half of it", observed / 2.0, alpha));
      for (const double dz : given_dz) out.push_back(needed(name, k, "given", dz, alpha));
    }
  }
  return out;
}

}  // namespace stillhand::study
