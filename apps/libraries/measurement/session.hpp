// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "services/core/recording/recording.hpp"

namespace stillhand::measurement {

/// One trial of a session's recording as rows, with notes for the reports.
struct SessionRows {
  recording::Recording rows;
  /// Gain and phase that the canceller followed, for each row; empty without its topic.  Separate
  /// from the rows, because they are no measurement.
  std::vector<std::array<double, 2>> weights;
  std::vector<std::string> notes;
  std::string loss;   ///< one line about data that the file has lost; empty: none
  std::string moves;  ///< the trial's name where the stick is not pegged; else empty
};

/// Reads the measured ticks of one trial from `stillhand/sensed` (a_x, a_y, a_z, roll, theta,
/// omega, f), `stillhand/motor_command` (f_motor, the force asked of the motor) and, of a tracking
/// trial, `stillhand/tracking_sample` (x_r, x_p).  A tick is a missing row if one of these topics
/// lacks it or the sensors gave no valid value.  The readable part of a damaged file is used.
/// @param trial  as ReadOptions::trial
/// @param last   of several trials that match take the last, instead of none
/// @throws stillhand::ConfigError when the file is no session's recording, or has no such trial.
SessionRows read_session_rows(const std::string& path, const std::string& trial, bool last = false);

}  // namespace stillhand::measurement
