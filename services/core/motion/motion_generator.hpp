// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/contract/config_field.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/contract/trial.hpp"
#include "services/core/motion/motion_trajectory.hpp"
#include "services/core/motion/platform_command.hpp"
#include "services/core/motion/platform_guard.hpp"

namespace stillhand::motion {

/// Core of the motion service: one platform command a tick.  Inside the armed trial it gives the
/// trajectory, at any other tick the middle at rest; always through the guard, so that an aborted
/// or late trial brakes and returns instead of jumping.
/// A gap in the ticks is stepped through (at most kMaxCatchUp ticks) and flagged kInputGap; a
/// repeated tick repeats the answer; a tick before the last one is a new sample clock.
/// step(), and arm() of what fits, never allocate, lock or throw; one thread.
class MotionGenerator {
 public:
  struct Config {
    PlatformLimits limits;

    template <typename Visitor, typename Self>
    static void fields(Visitor&& visit, Self& self) {
      visit.group("limits", self.limits);
    }
  };

  /// Longest gap stepped through [ticks]; from any state the guard is at rest well before.
  static constexpr Tick kMaxCatchUp = 1000;

  /// @throws stillhand::ConfigError when a limit is out of range.
  explicit MotionGenerator(const Config& config);

  /// Takes over the motion of a trial; `trajectory` is left with that of the one before, so that
  /// nothing is copied or freed here.
  /// @throws stillhand::ConfigError when their lengths differ or the trial is not sound().
  void arm(MotionTrajectory&& trajectory, const Trial& trial);
  /// The session announces a trial: the one that is armed begins at its start; in place of another
  /// one, which is over, the commands return to the middle.
  void announce(const Trial& trial) noexcept {
    if (trial.number != trial_.number) trial_ = Trial{};
    trial_.start_tick = trial.start_tick;
  }

  /// @param tick  the tick the command is for, not negative
  PlatformCommand step(Tick tick) noexcept;

  [[nodiscard]] const MotionTrajectory& trajectory() const noexcept { return trajectory_; }

 private:
  PlatformCommand advance(Tick tick) noexcept;

  PlatformGuard guard_;
  MotionTrajectory trajectory_;
  Trial trial_;
  PlatformCommand last_;
  Tick last_tick_ = -1;
};

}  // namespace stillhand::motion
