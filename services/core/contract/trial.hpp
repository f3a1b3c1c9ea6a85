// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/core/contract/tick.hpp"

namespace stillhand {

/// Purpose of a trial.
enum class TrialPhase : std::uint8_t {
  kIdle = 0,      ///< no trial runs; every force is zero
  kPegged = 1,    ///< stick held by the peg, idle hand: feedthrough identification (paper III-A)
  kTracking = 2,  ///< pursuit tracking (paper III-C)
  kFree = 3,      ///< stick free, the person holds it still: feedthrough to position
};

/// One trial on the sample clock.  Measured ticks are [start_tick, start_tick + duration_ticks).
/// Motion and target also run during `ramp_ticks` before and after, where they fade in and out.
/// The struct does not contain the condition: display and operator stay blinded.
struct Trial {
  std::int64_t number = -1;  ///< [-] counted from 0 in a session; -1: none yet
  TrialPhase phase = TrialPhase::kIdle;
  Tick start_tick = 0;      ///< first measured tick
  Tick duration_ticks = 0;  ///< [ticks] measured length
  Tick ramp_ticks = 0;      ///< [ticks] length of each ramp

  /// True if start, length and ramps are 0 to 2^60 ticks, so that their sum cannot overflow for any
  /// received message.  The functions below require it.
  [[nodiscard]] bool sound() const noexcept {
    constexpr Tick kLast = Tick{1} << 60;
    return start_tick >= 0 && start_tick <= kLast && duration_ticks >= 0 &&
           duration_ticks <= kLast && ramp_ticks >= 0 && ramp_ticks <= kLast;
  }
  /// True for the measured ticks and both ramps.
  [[nodiscard]] bool covers(Tick tick) const noexcept {
    return phase != TrialPhase::kIdle && tick >= start_tick - ramp_ticks &&
           tick < start_tick + duration_ticks + ramp_ticks;
  }
  /// True only for the measured ticks.
  [[nodiscard]] bool measures(Tick tick) const noexcept {
    return phase != TrialPhase::kIdle && tick >= start_tick && tick < start_tick + duration_ticks;
  }
};

}  // namespace stillhand
