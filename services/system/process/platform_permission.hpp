// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/contract/motion_leave.hpp"
#include "services/core/contract/trial.hpp"

namespace stillhand::runtime {

/// Whether the platform may move at a tick: the interlock of the person who sits on it.  The
/// announcement of a trial in a running session, to which a person's start leads, lets the platform
/// engage; it may follow commands where the trial covers the tick.  If a part fails after it was
/// sound, or within the trial, the platform holds for the rest of the trial: motion must not come
/// back by surprise.  It also holds after kMostMissing_ticks without a command in the trial, and
/// for good after a stop.  Pure; one thread.
class PlatformPermission {
 public:
  struct Input {
    bool runs = false;     ///< the session runs: it began, is not paused, and does not end
    bool sound = false;    ///< every process lives, each the one source, and every part works
    bool command = false;  ///< a command for this tick came
  };

  /// A command that is missing brakes at once; for longer than this motion has to be looked at.
  static constexpr Tick kMostMissing_ticks = 100;

  MotionLeave step(const Trial& trial, Tick tick, const Input& input) noexcept {
    const bool covers = trial.covers(tick);
    const bool announced = trial.number >= 0 && trial.phase != TrialPhase::kIdle &&
                           (covers || tick < trial.start_tick);
    // A trial in place of another one begins at rest, too.
    const bool other = trial.number != trial_;
    trial_ = trial.number;
    if (!announced || !input.runs || other) {
      missing_ticks_ = 0;
      return MotionLeave::kHold;
    }
    missing_ticks_ = covers && !input.command ? missing_ticks_ + 1 : 0;
    const bool lost = missing_ticks_ > kMostMissing_ticks;
    if (trial.number != sound_trial_ && input.sound) sound_trial_ = trial.number;
    const bool unsound = !input.sound && (covers || trial.number == sound_trial_);
    if ((unsound || lost) && latched_trial_ != trial.number) {
      latched_trial_ = trial.number;
      motion_lost_ = lost && input.sound;
    }
    if (stopped_ || !input.sound || trial.number == latched_trial_) return MotionLeave::kHold;
    return covers ? MotionLeave::kFollow : MotionLeave::kEngage;
  }
  /// For good.
  void stop() noexcept { stopped_ = true; }
  /// True when the trial lost its permission for good.
  [[nodiscard]] bool latched(const Trial& trial) const noexcept {
    return stopped_ || (trial.number >= 0 && trial.number == latched_trial_);
  }
  /// It did, since motion's commands stayed away.
  [[nodiscard]] bool motion_lost(const Trial& trial) const noexcept {
    return motion_lost_ && trial.number >= 0 && trial.number == latched_trial_;
  }

 private:
  std::int64_t trial_ = -1;  ///< newest
  std::int64_t latched_trial_ = -2;
  std::int64_t sound_trial_ = -2;  ///< newest announcement in which everything was right
  Tick missing_ticks_ = 0;
  bool motion_lost_ = false;
  bool stopped_ = false;
};

}  // namespace stillhand::runtime
