// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

namespace stillhand::device_rig {

/// What a drive does, in the words of DR-4 to DR-8; each protocol says which of its states these
/// are.
enum class DriveMode : std::uint8_t {
  kOff,       ///< driver off, no fault
  kTorque,    ///< it follows torque commands, with its watchdog
  kFault,     ///< it reports a fault
  kTimedOut,  ///< its watchdog tripped; driver off until it is stopped
  kOther      ///< a state that Stillhand does not command
};

/// State of a drive, as one reply reports it.  Position, velocity and torque are those of the
/// stick's shaft.
struct DriveReply {
  DriveMode mode = DriveMode::kOff;
  int fault = 0;  ///< its number
  double position_rev = kNone;
  double velocity_rev_s = kNone;
  double torque_n_m = kNone;  ///< measured
  double voltage_v = kNone;
  double temperature_c = kNone;
  double analog1 = kNone;  ///< first analogue input, 0 to 1
  double analog2 = kNone;  ///< second
  int milliseconds = 0;    ///< counter of 16 bit
  bool whole = false;      ///< everything that decides was in it
  bool refused = false;    ///< it holds an error: another firmware does not know a register

  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace stillhand::device_rig
