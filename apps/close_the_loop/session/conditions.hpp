// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/close_the_loop/session/closed_loop.hpp"
#include "apps/libraries/session/core/trial_numbers.hpp"

namespace stillhand::close_the_loop {

/// The conditions of the loop, in the order of its tables.
inline constexpr std::array<const char*, 5> kConditions{"A", "B", "C", "C'", "C+"};
/// Those in which the motor acts.
inline constexpr std::array<const char*, 3> kCancelling{"C", "C'", "C+"};

/// The two steps whose differences are given: following, then the model of the effect.
inline constexpr std::array<std::pair<const char*, const char*>, 2> kSteps{
    {{"C", "C'"}, {"C'", "C+"}}};
/// "C-C'"
std::string step_name(const std::string& from, const std::string& to);

using session::index_of;
using session::kNumbers;
using session::Number;

/// Whether a condition has a number: some are of the motor alone.
bool has(const std::string& label, const Number& number);

/// The trials of each condition, by its label.  Entry r of each is of repeat r: same motion, same
/// target, same remnant.  At least one entry.
using Conditions = std::map<std::string, std::vector<TrialRun>>;

/// The loop's own trials: one repeat, in which motion, target and remnant are the same for C, C'
/// and C+ alone.
Conditions own_trials(const LoopResult& result);

/// A number over the repeats, without those in which it could not be computed.
struct Estimate {
  std::vector<double> values;
  double mean = 0.0;                                    ///< NaN without any value
  std::optional<std::pair<double, double>> interval95;  ///< of the mean, Student's t; from two on
};

Estimate estimate(const std::vector<double>& values);
/// A number of a condition.
Estimate measured(const Conditions& conditions, const std::string& label, const Number& number);
/// Differences `to` - `from` of a number, repeat by repeat.
Estimate change(const Conditions& conditions, const std::string& from, const std::string& to,
                const Number& number);
/// (B - X)/(B - A) of a number, repeat by repeat.
Estimate restored(const Conditions& conditions, const std::string& label, const Number& number);

/// A number that is worse with C+ than with another condition, its interval above 0.
struct Harm {
  const Number* number;
  const char* than;  ///< "C" or "C'"
  Estimate rise;
};

/// Whether C+ is kept, METHOD Eq. CL-10: by what its motor leaves in trials that no fit has seen.
struct LoopDecision {
  const Number* measure = &kNumbers[index_of("force_left_n")];
  Estimate over_c;             ///< change of the measure from C to C+, repeat by repeat
  Estimate over_c_prime;       ///< from C' to C+
  bool augmented = false;      ///< C+ ran with the augmented model; else it is C'
  std::vector<Harm> harms;     ///< what C+ makes worse, whether it is kept or not
  const char* model_of = "C";  ///< condition whose model the loop writes

  [[nodiscard]] bool kept() const;
};

LoopDecision decide(const Conditions& conditions, const LoopResult& result);
/// The model that the loop writes for the canceller.
cancellation::ControlModel chosen_model(const LoopResult& result, const LoopDecision& decision);

}  // namespace stillhand::close_the_loop
