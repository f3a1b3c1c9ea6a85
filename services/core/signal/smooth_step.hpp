// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::signal {

/// From 0 to 1 with speed and acceleration zero at both ends, Eq. SG-18, and its derivatives by u:
///
///   x = 10 u^3 - 15 u^4 + 6 u^5,   x' = 30 u^2 (1 - u)^2,   x'' = 60 u (1 - u) (1 - 2 u)
///
/// @param u  0 to 1.  Pure.
inline double smooth_step(double u) noexcept { return u * u * u * (10.0 + u * (6.0 * u - 15.0)); }
inline double smooth_step_speed(double u) noexcept { return 30.0 * u * u * (1.0 - u) * (1.0 - u); }
inline double smooth_step_bend(double u) noexcept { return 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u); }

}  // namespace stillhand::signal
