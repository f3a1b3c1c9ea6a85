// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/contract/trial.hpp"

namespace stillhand::runtime {

/// Whether a motor force is permitted at a tick.  Closed while a trial covers the tick and every
/// required process is alive.  Once a process was missing during a trial it stays open until
/// another trial: a force must not come back by surprise.  After an emergency stop it never closes
/// again.  Pure; one thread.
class Interlock {
 public:
  bool step(const Trial& trial, Tick tick, bool peers_alive) noexcept {
    if (trial.number != latched_trial_ && trial.covers(tick) && !peers_alive) {
      latched_trial_ = trial.number;
    }
    return trial.covers(tick) && peers_alive && trial.number != latched_trial_ && !stopped_;
  }
  /// Opens it for good.
  void stop() noexcept { stopped_ = true; }
  [[nodiscard]] bool stopped() const noexcept { return stopped_; }
  /// True when the trial lost its permission for good.
  [[nodiscard]] bool latched(const Trial& trial) const noexcept {
    return stopped_ || (trial.number >= 0 && trial.number == latched_trial_);
  }

 private:
  std::int64_t latched_trial_ = -2;
  bool stopped_ = false;
};

}  // namespace stillhand::runtime
