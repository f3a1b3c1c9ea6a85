// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/contract/flag.hpp"

namespace stillhand::motion {

/// Where the platform is to be at one tick.  Frame: lateral, positive to the subject's right, zero
/// in the middle of the travel.  The three are samples of one motion: v = dx/dt, a = dv/dt.
struct PlatformCommand {
  double position_m = 0.0;         ///< [m]
  double velocity_m_s = 0.0;       ///< [m/s]
  double acceleration_m_s2 = 0.0;  ///< [m/s^2]
  Flags flags = kGood;             ///< contract/flag.hpp
};

}  // namespace stillhand::motion
