// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace stillhand {

/// Sample index of the sample clock [-], counted from the start of the rig (or of the sensing
/// hardware).  The one clock of the control loop: cores know no other time.
using Tick = std::int64_t;

/// Control rate of the experiment [Hz]; paper section III-C ("motion control was managed at 1000
/// Hz").
inline constexpr double kControlRateHz = 1000.0;
/// One tick [s].
inline constexpr double kControlPeriod_s = 1.0 / kControlRateHz;

/// Ticks in a duration, rounded to the nearest; duration_s [s] finite.
constexpr Tick ticks_in(double duration_s) noexcept {
  return static_cast<Tick>(duration_s * kControlRateHz + (duration_s < 0.0 ? -0.5 : 0.5));
}

/// From a model's publication to the first tick that it may be used at [ticks]: long enough that
/// whoever uses it takes it at that very tick, so that a replay answers as the session did.
inline constexpr Tick kModelNotice_ticks = 250;

}  // namespace stillhand
