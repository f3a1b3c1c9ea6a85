// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "services/recording/core/recording.hpp"

namespace stillhand::measurement {

/// One trial of a session's recording as rows, and what to say about it.
struct SessionRows {
  recording::Recording rows;
  /// Gain and phase that the canceller followed, a row each; none without its topic.  Beside the
  /// rows: it is no measurement.
  std::vector<std::array<double, 2>> weights;
  std::vector<std::string> notes;
  std::string loss;  ///< one line on what the file has lost; empty: it is whole
};

/// Reads the measured ticks of one trial from `stillhand/sensed` (a_x, a_y, a_z, roll, theta,
/// omega, f), `stillhand/motor_command` (f_motor, what is asked of the motor) and, of a tracking
/// trial, `stillhand/tracking_sample` (x_r, x_p).  Ticks at which one
/// of them is missing, or the sensors gave nothing valid, are missing rows.  What of a damaged file
/// can be read is used.
/// @param trial  as ReadOptions::trial
/// @throws stillhand::ConfigError when it is no session's recording, or has no such trial.
SessionRows read_session_rows(const std::string& path, const std::string& trial);

}  // namespace stillhand::measurement
