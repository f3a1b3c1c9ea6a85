// SPDX-License-Identifier: Apache-2.0
#include "apps/study/report_cells.hpp"

#include <fmt/format.h>

#include "apps/report/text.hpp"

namespace stillhand::study {

using report::number;
using report::short_number;
using session::kMetrics;

int decimals(std::size_t metric) { return metric == 0 ? 1 : 2; }

double paper_value(std::size_t metric, Condition condition) {
  const session::Metric& what = kMetrics[metric];
  const double unit = metric == 0 ? kPaperUnit_mm : 1.0;
  return unit * (condition == kA ? what.paper_a : condition == kB ? what.paper_b : what.paper_c);
}

// A tail below the range of a double is 0, but no probability is.
std::string p_value(double p) { return p > 0.0 ? short_number(p) : "< 10⁻³⁰⁰"; }

std::string percent(double share) { return number(100.0 * share, 0) + " %"; }

std::string restored_text(const Analysis& analysis, std::size_t metric, Condition condition) {
  const auto found = analysis.restoration.find(condition);
  if (found == analysis.restoration.end() || !found->second[metric].share) return "–";
  std::string out = percent(*found->second[metric].share);
  if (const auto& interval = found->second[metric].interval) {
    out += fmt::format(" [{:.0f}, {:.0f}]", 100.0 * interval->low, 100.0 * interval->high);
  }
  return out;
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
