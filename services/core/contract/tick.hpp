// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace stillhand {

/// Sample index of the sample clock [-], counted from the start of the rig (or of the sensing
/// hardware).  It is the only clock of the control loop; cores use no other time.
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

/// Time from the publication of a model to the first tick at which it may be used [ticks].  It is
/// long enough for the canceller to take the model at exactly this tick, so a replay gives the same
/// answers as the session.
inline constexpr Tick kModelNotice_ticks = 250;

}  // namespace stillhand
