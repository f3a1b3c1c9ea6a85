// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/study/recorded/find_sessions.hpp"
#include "apps/study/recorded/recorded_trial.hpp"

namespace stillhand::study {

/// What one recording gives to a study.
struct RecordedSession {
  std::optional<Identification> identification;  ///< of the last complete pegged trial
  double identify_s = 0.0;                       ///< [s] its length
  std::vector<RecordedTrial> trials;    ///< complete tracking trials without practice; no place
  std::vector<RecordedTrial> practice;  ///< complete practice trials
  std::vector<std::string> left_out;    ///< one line each: trial, and why
  bool control_model = false;           ///< the motor used a control model (C' or C+)
};

/// A trial is complete if it was not ended early and has 99 % of its samples.
/// @throws ConfigError for a recording that cannot be read
RecordedSession read_recorded_session(const SessionFile& file);

}  // namespace stillhand::study
