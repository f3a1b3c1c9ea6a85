// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "services/core/contract/tick.hpp"

namespace stillhand::display {

/// What a mitigation takes off the stick's angle at a tick.
struct TakenOff {
  Tick tick = -1;          ///< of the motor command that states it, -1 none
  double angle_rad = 0.0;  ///< exactly 0 without a mitigation
};

/// Decides which motor command's angle is taken off a sensed sample, README Eq. DI-10: that of the
/// newest command, for at most kMostAge_ticks; without one the cursor follows the raw stick.  The
/// command of the sample itself is still on its way as a rule, so the angle is one tick late.  The
/// sample does not wait: a cursor without a mitigation is as early as before.
/// Pure; one thread; nothing allocates or throws.
class CommandInUse {
 public:
  /// As long as the rig drives the motor by a command (rig, motor.max_motor_age_ticks).
  static constexpr Tick kMostAge_ticks = 10;

  void offer(const TakenOff& newest) noexcept { newest_ = newest; }

  [[nodiscard]] TakenOff at(Tick tick) const noexcept {
    const bool usable = newest_.tick >= 0 && newest_.tick <= tick &&
                        tick - newest_.tick <= kMostAge_ticks && std::isfinite(newest_.angle_rad);
    return usable ? newest_ : TakenOff{};
  }

 private:
  TakenOff newest_;
};

}  // namespace stillhand::display
