// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

namespace stillhand::session {

/// What a trial with a moving platform sensed; equally long.
struct SensedMotion {
  std::vector<double> accel_m_s2;  ///< a_y
  std::vector<double> theta_rad;   ///< stick angle
};

/// An estimate with its 95 % interval.
struct SensedShare {
  double share = 0.0;  ///< [-]
  double low = 0.0;
  double high = 0.0;
};

/// Share of the feedthrough that was cancelled, from sensed signals alone, README Eq. SN-7: what
/// the acceleration moves the stick by with cancellation, next to without it.  It holds the part
/// that is coherent with the acceleration, and assumes that the arm is the same in both trials.
/// @param moving     without cancellation (condition B)
/// @param cancelled  with it
/// @param rate_hz    [Hz] of the signals
/// @returns nothing for trials shorter than 12 s, or without motion
std::optional<SensedShare> sensed_share(const SensedMotion& moving, const SensedMotion& cancelled,
                                        double rate_hz);

}  // namespace stillhand::session
