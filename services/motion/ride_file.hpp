// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace stillhand::motion {

/// A recorded ride as the platform can follow it: lateral acceleration at one rate, no gaps.
struct Ride {
  double rate_hz = 0.0;
  std::vector<double> accel_m_s2;
};

/// Reads a ride: the column `a_y [m/s^2]` of a CSV file, or `stillhand/sensed` of an MCAP recording
/// (by the file name's ending).
/// @throws ConfigError when the file cannot be read, holds no lateral acceleration, or has gaps.
Ride read_ride(const std::string& path);

}  // namespace stillhand::motion
