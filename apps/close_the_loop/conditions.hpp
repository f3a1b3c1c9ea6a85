// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/close_the_loop/closed_loop.hpp"

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

/// One number of a tracking trial.
struct Measure {
  const char* key;    ///< in summary.json
  const char* title;  ///< with its unit
  int decimals;
  double (*of)(const TrialRun&);
};

/// The paper's three metrics come first, session::kMetrics; README, "Measures".
inline constexpr std::array<Measure, 10> kMeasures{{
    {"rms_error_mm", "RMS error [mm]", 2,
     [](const TrialRun& run) { return run.metrics.rms_error_mm; }},
    {"dwell_ratio", "dwell ratio [-]", 3,
     [](const TrialRun& run) { return run.metrics.dwell_ratio; }},
    {"crossover_hz", "crossover f_c [Hz]", 3,
     [](const TrialRun& run) { return run.metrics.crossover_hz; }},
    {"force_left_n", "force left [N]", 3, [](const TrialRun& run) { return run.forces.left_n; }},
    {"hand_acceleration_m_s2", "hand's acceleration [m/s²]", 3,
     [](const TrialRun& run) { return run.forces.acceleration_m_s2; }},
    {"motor_force_n", "motor's force [N]", 3,
     [](const TrialRun& run) { return run.forces.motor_n; }},
    {"volitional_force_n", "subject's force [N]", 3,
     [](const TrialRun& run) { return run.forces.volitional_n; }},
    {"crossover_reference_hz", "crossover by the reference [Hz]", 3,
     [](const TrialRun& run) { return run.metrics.crossover_reference_hz; }},
    {"cancelled_share", "feedthrough force cancelled [-]", 3,
     [](const TrialRun& run) { return run.cancelled_share; }},
    {"counterforce_delay_ms", "delay of the counterforce [ms]", 1,
     [](const TrialRun& run) { return 1e3 * run.counterforce_delay_s; }},
}};
/// Of kMeasures, those that every condition has; the two behind them belong to kCancelling.
inline constexpr std::size_t kMeasuresOfAll = 8;
/// Positions in kMeasures.
inline constexpr std::size_t kRmsError = 0;
inline constexpr std::size_t kForceLeft = 3;
inline constexpr std::size_t kReference = 7;
/// Whether a condition has a measure.
bool has(const std::string& label, std::size_t measure);

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
/// A measure of a condition.
Estimate measured(const Conditions& conditions, const std::string& label, const Measure& measure);
/// Differences `to` - `from` of a measure, repeat by repeat.
Estimate change(const Conditions& conditions, const std::string& from, const std::string& to,
                const Measure& measure);
/// (B - X)/(B - A) of a measure, repeat by repeat.
Estimate restored(const Conditions& conditions, const std::string& label, const Measure& measure);

/// Whether C+ is kept, METHOD Eq. CL-10: by what its motor leaves in trials that no fit has seen.
struct LoopDecision {
  std::size_t measure = kForceLeft;  ///< in kMeasures
  Estimate over_c;                   ///< change of the measure from C to C+, repeat by repeat
  Estimate over_c_prime;             ///< from C' to C+
  bool augmented = false;            ///< C+ ran with the augmented model; else it is C'
  const char* model_of = "C";        ///< condition whose model the loop writes

  [[nodiscard]] bool kept() const {
    return augmented && over_c.mean < 0.0 && over_c_prime.mean < 0.0;
  }
  /// Neither interval contains 0.
  [[nodiscard]] bool certain() const;
};

LoopDecision decide(const Conditions& conditions, const LoopResult& result);
/// The model that the loop writes for the canceller.
cancellation::ControlModel chosen_model(const LoopResult& result, const LoopDecision& decision);

}  // namespace stillhand::close_the_loop
