// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/libraries/session/core/trial_numbers.hpp"
#include "apps/libraries/session/force_budget.hpp"
#include "apps/libraries/session/misses.hpp"
#include "apps/libraries/session/on_time.hpp"
#include "apps/libraries/session/sensed_share.hpp"
#include "apps/libraries/session/session_recording.hpp"
#include "apps/libraries/session/trial_outcome.hpp"

namespace stillhand::session {

/// 12 s of a trial at 100 Hz, for a figure: the first, or those around the loss of the model.  All
/// arrays are equally long.
struct Excerpt {
  std::vector<double> time_s;         ///< from the trial's start
  std::vector<double> feedthrough_n;  ///< f', the force the body would exert with the stick held
  std::vector<double> motor_n;        ///< f_m, the motor's
  std::vector<double> target_mm, cursor_mm;
};

/// One tracking trial, computed from the recording alone.  The cancelled share is known only where
/// the platform moves, the delay of the counterforce only where a prediction of f' is all that
/// drives the motor: a shaped stick answers the stick's motion.
struct TrialResult : TrialNumbers {
  std::int64_t number;
  Condition label;
  /// The cancelled share from what is sensed, next to the session's trial without cancellation, Eq.
  /// SN-7.
  std::optional<SensedShare> sensed_share;
  /// RMS of the error of pursuit behind the trial's first third, as in the study's table of
  /// mitigations (SU-19): what adapts may settle in it.
  double settled_rms_error_mm = 0.0;
  std::optional<ForceBudget> budget;  ///< of condition C alone, where the feedthrough is known
  /// Numbers, in the recording, of the models that the trial ran; none: it ran none of that kind.
  struct Models {
    std::optional<std::int32_t> force;     ///< as the motor commands name it
    std::optional<std::int32_t> position;  ///< newest usable one of an earlier trial
  };
  Models models;
  /// From a sample's acquisition to the command that answers it, by their stamps; the same.  Stamps
  /// of other hosts are taken over to the experiment's clock.
  struct Latency {
    double p50_us = 0.0;
    double p99_us = 0.0;
    double max_us = 0.0;
    double uncertainty_us = 0.0;  ///< of the offset between the two clocks; 0: one clock
  };
  std::optional<Latency> sensor_to_command;
  /// From a sample's acquisition to the rig's step that first used the command that answers it.
  std::optional<Latency> sensor_to_force;
  /// Share of the measured ticks that used the command that answers their own sample; the same.
  std::optional<double> same_tick_share;
  std::optional<double> model_lost_s;  ///< [s] of the trial: its model no longer held (marks.hpp)
  Excerpt excerpt;                     ///< only where the platform moves
};

/// What the model predicts of the pegged trial's true feedthrough force, as residual share
/// RMS(f' - f_hat) / RMS(f'), for the filter at 1 kHz and for the 50 Hz model behind a zero-order
/// hold, over one tracking trial with motion.
struct RateConversionCost {
  double control_filter = 0.0;
  double zero_order_hold = 0.0;
};

/// The part of a session's summary that is computed from the recording.
/// A process was late while a trial that counts was measured, by more than a force command may be
/// old: the force went down, and the trial's figures hold what that did.
struct Disturbance {
  Condition label;  ///< of the trial
  Miss miss;
};

struct SessionResult {
  std::vector<TrialResult> trials;
  std::map<std::int64_t, std::string> unrecorded;  ///< by trial: why it does not count
  std::optional<stillhand_msgs::FeedthroughModel> model;
  std::optional<RateConversionCost> conversion;
  std::map<std::string, std::int64_t> lost_ticks;  ///< by 1 kHz topic
  std::vector<std::string> damage;
  std::string rig_parts;  ///< as the recording says it (parts_note.hpp); empty: all simulated
  std::map<std::string, stillhand_msgs::ClockOffset> clocks;  ///< by process, the last that came
  std::vector<Disturbance> disturbances;                      ///< in time
};

/// Computes the completed trials' results from a recording.  One of which it lacks a second or more
/// does not count, whatever was reported while it ran.
/// @param answers  settings that the session ran with, for ForceBudget; none: it is left out
/// @throws ConfigError when the recording cannot be read.
SessionResult evaluate(const std::string& recording, const std::vector<TrialOutcome>& outcomes,
                       const std::optional<AnswerConfigs>& answers = {});

}  // namespace stillhand::session
