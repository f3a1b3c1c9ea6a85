// SPDX-License-Identifier: Apache-2.0
#include "apps/study/report/report_cells.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/libraries/report/text/text.hpp"

namespace stillhand::study {

using report::number;
using session::kMetrics;

int decimals(std::size_t metric) { return session::kNumbers[metric].decimals; }

bool has_test(const Comparison& comparison) {
  return std::ranges::any_of(comparison.tests, [](const auto& test) { return test.has_value(); });
}

double paper_value(std::size_t metric, Condition condition) {
  return kMetrics[metric].paper->means().at(condition == kA ? 0 : condition == kB ? 1 : 2);
}

std::string restored_text(const Analysis& analysis, std::size_t metric, Condition condition) {
  const auto found = analysis.restoration.find(condition);
  if (found == analysis.restoration.end() || !found->second[metric].share) return "–";
  const auto mean = [&](Condition of) { return analysis.conditions.at(of)[metric].mean; };
  if (!session::kMetrics[metric].worse(mean(kA), mean(kB))) return report::kNotWorse;
  std::optional<std::pair<double, double>> ends;
  if (const auto& interval = found->second[metric].interval) {
    ends.emplace(interval->low, interval->high);
  }
  return report::restored(*found->second[metric].share, ends);
}

const Comparison* find_comparison(const Analysis& analysis, Condition from, Condition to) {
  for (const Comparison& comparison : analysis.comparisons) {
    if (comparison.from == from && comparison.to == to) return &comparison;
  }
  return nullptr;
}

std::string mean_and_deviation(const MetricSample& sample, std::size_t metric) {
  std::string out = number(sample.mean, decimals(metric));
  if (sample.standard_deviation) {
    out += " ± " + number(*sample.standard_deviation, decimals(metric));
  }
  if (sample.known < sample.per_subject.size()) out += fmt::format(" (n = {})", sample.known);
  return out;
}

}  // namespace stillhand::study
