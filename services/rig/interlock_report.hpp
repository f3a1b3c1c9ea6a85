// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/contract/tick.hpp"

namespace stillhand::rig {

/// When the interlock's opening is told, and when that the force is zero: once each, and once more
/// when an emergency stop follows an opening for another reason.  Pure; one thread.
class InterlockReport {
 public:
  struct Told {
    bool opened = false;
    bool force_zero = false;
    Tick after_ticks = 0;  ///< from the opening to the force's zero
  };

  /// @param latched  the interlock is open for good, for this trial or after a stop
  /// @param stopped  by an emergency stop
  Told step(bool latched, bool stopped, Tick tick, double motor_force_n) noexcept {
    if (!latched) {
      opened_tick_ = kNotOpen;
      return {};
    }
    Told told;
    if (opened_tick_ == kNotOpen || stopped != stopped_) {
      told.opened = true;
      opened_tick_ = tick;
      zero_ = false;
    }
    stopped_ = stopped;
    if (!zero_ && motor_force_n == 0.0) {
      zero_ = true;
      told.force_zero = true;
      told.after_ticks = tick - opened_tick_;
    }
    return told;
  }

 private:
  static constexpr Tick kNotOpen = -1;
  Tick opened_tick_ = kNotOpen;
  bool stopped_ = false;
  bool zero_ = false;
};

}  // namespace stillhand::rig
