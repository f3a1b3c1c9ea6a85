// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/session/conditions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/close_the_loop/verdict/gain.hpp"
#include "services/core/statistics/descriptive.hpp"

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

// Of a number of which less is better.
bool falls(const Estimate& change) {
  std::optional<std::pair<double, double>> saved95;
  if (change.interval95) saved95 = {-change.interval95->second, -change.interval95->first};
  return is_gain(-change.mean, saved95);
}

std::vector<Harm> harms_of(const Conditions& conditions) {
  std::vector<Harm> harms;
  for (const char* than : {"C", "C'"}) {
    for (const Number& number : kNumbers) {
      if (!number.lower_is_better || !has(than, number)) continue;
      const Estimate rise = change(conditions, than, "C+", number);
      if (rise.interval95 && rise.interval95->first > 0.0) harms.push_back({&number, than, rise});
    }
  }
  return harms;
}

}  // namespace

std::string step_name(const std::string& from, const std::string& to) { return from + "-" + to; }

bool has(const std::string& label, const Number& number) {
  return number.still == session::Still::kGiven ||
         std::ranges::find(kCancelling, label) != kCancelling.end();
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

Estimate measured(const Conditions& conditions, const std::string& label, const Number& number) {
  const auto value = [&](const TrialRun& run) { return number.of(run); };
  return each_repeat(conditions, value, label);
}

Estimate change(const Conditions& conditions, const std::string& from, const std::string& to,
                const Number& number) {
  const auto difference = [&](const TrialRun& first, const TrialRun& second) {
    return number.of(second) - number.of(first);
  };
  return each_repeat(conditions, difference, from, to);
}

Estimate restored(const Conditions& conditions, const std::string& label, const Number& number) {
  const auto share = [&](const TrialRun& a, const TrialRun& b, const TrialRun& x) {
    return (number.of(b) - number.of(x)) / (number.of(b) - number.of(a));
  };
  return each_repeat(conditions, share, std::string("A"), std::string("B"), label);
}

bool LoopDecision::kept() const { return augmented && falls(over_c) && falls(over_c_prime); }

LoopDecision decide(const Conditions& conditions, const LoopResult& result) {
  const Verdict& verdict = result.verdict();
  const bool drive_alone = verdict.strongest() != nullptr &&
                           std::ranges::all_of(verdict.findings, [](const Finding& finding) {
                             return !finding.counts || finding.where == kDrive;
                           });
  LoopDecision out;
  // The force left is the feedthrough's: what the motor does about the drive counts as left.
  if (drive_alone) out.measure = &kNumbers[index_of("rms_error_mm")];
  const Number& measure = *out.measure;
  out.over_c = change(conditions, "C", "C+", measure);
  out.over_c_prime = change(conditions, "C'", "C+", measure);
  out.augmented = result.rounds[result.final_round].augmented;
  if (out.augmented) out.harms = harms_of(conditions);
  if (out.kept()) {
    out.model_of = "C+";
  } else if (falls(change(conditions, "C", "C'", measure))) {
    out.model_of = "C'";
  }
  return out;
}

cancellation::ControlModel chosen_model(const LoopResult& result, const LoopDecision& decision) {
  const std::string of = decision.model_of;
  if (of == "C+") return result.rounds[result.final_round].model;
  if (of == "C'") return result.followed_model;
  return cancellation::control_model(result.paper_model.control);
}

}  // namespace stillhand::close_the_loop
