// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace stillhand::motion {

/// A ride as it was recorded: lateral acceleration at one rate, no gaps.
struct RideRecord {
  double rate_hz = 0.0;
  std::vector<double> accel_m_s2;
  std::string source;  ///< file, for messages

  [[nodiscard]] double length_s() const noexcept {
    return static_cast<double>(accel_m_s2.size()) / rate_hz;
  }
};

/// Reads a ride: the column `a_y [m/s^2]` of a CSV file, or `stillhand/sensed` of an MCAP recording
/// of a session (by the file name's ending), from its first sample on.  A session on a busy machine
/// loses a tick now and then: up to ten in a row are bridged by a straight line.
/// @throws ConfigError when the file cannot be read, holds no lateral acceleration, or has gaps.
RideRecord read_ride(const std::string& path);

}  // namespace stillhand::motion
