// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/conditions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/statistics/descriptive.hpp"

namespace stillhand::close_the_loop {
namespace {

// One value a repeat, from its trials of the given conditions.
template <typename Value, typename... Labels>
Estimate each_repeat(const Conditions& conditions, Value value, const Labels&... labels) {
  std::vector<double> values;
  for (std::size_t r = 0; r < conditions.at("A").size(); ++r) {
    values.push_back(value(conditions.at(labels)[r]...));
  }
  return estimate(values);
}

}  // namespace

std::string step_name(const std::string& from, const std::string& to) { return from + "-" + to; }

bool has(const std::string& label, std::size_t measure) {
  return measure < kMeasuresOfAll || std::ranges::find(kCancelling, label) != kCancelling.end();
}

Conditions own_trials(const LoopResult& result) {
  Conditions out;
  for (const char* label : kConditions) {
    const bool plus = label == std::string("C+");
    out[label] = {plus ? result.plus() : result.trial(label)};
  }
  return out;
}

Estimate estimate(const std::vector<double>& values) {
  Estimate out;
  for (const double value : values) {
    if (std::isfinite(value)) out.values.push_back(value);
  }
  out.mean =
      out.values.empty() ? std::numeric_limits<double>::quiet_NaN() : statistics::mean(out.values);
  if (out.values.size() >= 2) {
    const auto interval = statistics::mean_interval(out.values);
    out.interval95 = {interval.low, interval.high};
  }
  return out;
}

Estimate measured(const Conditions& conditions, const std::string& label, const Measure& measure) {
  return each_repeat(conditions, measure.of, label);
}

Estimate change(const Conditions& conditions, const std::string& from, const std::string& to,
                const Measure& measure) {
  const auto difference = [&](const TrialRun& first, const TrialRun& second) {
    return measure.of(second) - measure.of(first);
  };
  return each_repeat(conditions, difference, from, to);
}

Estimate restored(const Conditions& conditions, const std::string& label, const Measure& measure) {
  const auto share = [&](const TrialRun& a, const TrialRun& b, const TrialRun& x) {
    return (measure.of(b) - measure.of(x)) / (measure.of(b) - measure.of(a));
  };
  return each_repeat(conditions, share, std::string("A"), std::string("B"), label);
}

}  // namespace stillhand::close_the_loop
