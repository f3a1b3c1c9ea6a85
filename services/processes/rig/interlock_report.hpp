// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/contract/tick.hpp"

namespace stillhand::rig {

/// Decides when the rig reports that the interlock opened and that the force is zero. It reports
/// each once, and again if an emergency stop follows an opening for another reason.
/// Pure; one thread.
class InterlockReport {
 public:
  struct Notice {
    bool opened = false;
    bool force_zero = false;
    Tick after_ticks = 0;  ///< from the opening to zero force
  };

  /// @param latched  the interlock stays open, for this trial or after a stop
  /// @param stopped  an emergency stop opened it
  Notice step(bool latched, bool stopped, Tick tick, double motor_force_n) noexcept {
    if (!latched) {
      opened_tick_ = kNotOpen;
      return {};
    }
    Notice notice;
    if (opened_tick_ == kNotOpen || stopped != stopped_) {
      notice.opened = true;
      opened_tick_ = tick;
      zero_ = false;
    }
    stopped_ = stopped;
    if (!zero_ && motor_force_n == 0.0) {
      zero_ = true;
      notice.force_zero = true;
      notice.after_ticks = tick - opened_tick_;
    }
    return notice;
  }

 private:
  static constexpr Tick kNotOpen = -1;
  Tick opened_tick_ = kNotOpen;
  bool stopped_ = false;
  bool zero_ = false;
};

}  // namespace stillhand::rig
