// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "services/core/contract/config_field.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/motion/platform_command.hpp"

namespace stillhand::motion {

/// What the platform may do.  Process settings only: no message or file of a trial can raise them.
struct PlatformLimits {
  double max_position_m = 0.15;
  double max_velocity_m_s = 1.25;
  double max_acceleration_m_s2 = 9.0;
  double stop_acceleration_m_s2 = 3.0;
  double catch_up_rad_s = 20.0;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("max_position_m", self.max_position_m, Range{0.001, 0.15},
          "[m] travel either side of the middle; paper III-C, +-0.15 m");
    visit("max_velocity_m_s", self.max_velocity_m_s, Range{0.01, 3.0},
          "[m/s] fastest motion; assumed: 25 mm ball-screw lead at 3000 rpm (paper gives none)");
    visit("max_acceleration_m_s2", self.max_acceleration_m_s2, Range{0.1, 15.0},
          "[m/s^2] hardest acceleration; above the paper's 7.5 m/s^2 peak, III-C");
    visit("stop_acceleration_m_s2", self.stop_acceleration_m_s2, Range{0.05, 15.0},
          "[m/s^2] deceleration when the command is missing, and of the catching up; the wall "
          "may demand more");
    visit("catch_up_rad_s", self.catch_up_rad_s, Range{1.0, 100.0},
          "[rad/s] how fast a remaining error closes; 20 rad/s = 3.2 Hz, half the platform's "
          "bandwidth (paper III-C, > 6 Hz)");
  }
};

/// One tick of what is asked.
struct GuardInput {
  bool valid = false;       ///< a command for this tick exists
  PlatformCommand command;  ///< ignored unless valid; its flags are passed on
};

/// The last thing every platform command passes through.  Whatever is asked, every output obeys
/// |x| <= X, |v| <= V, |a| <= A and can stop before the wall, Eq. MO-1:
///
///   x + v|v| / (2 A)  within +-X
///
/// A command is passed on bit for bit when a motion within the limits leads to it, Eq. MO-2:
///
///   |v1 - v0| <= A dt,  |x1 - x0 - (v0 + v1) dt/2| <= (A^2 dt^2 - (v1 - v0)^2) / (4 A),  and MO-1
///
/// Otherwise the guard moves with one constant acceleration a tick, towards the command (Eq. MO-3)
/// or, with no valid command, to rest (Eq. MO-4), the end velocity clipped to the set from which
/// MO-1 holds again, Eq. MO-5.  With a jerk J the acceleration changes by at most J dt a tick, as
/// far as MO-1 allows it, Eq. MO-16.  Derivations: services/processes/motion/README.md.
/// Pure; step() never allocates or throws; one thread.
class PlatformGuard {
 public:
  static constexpr double kAnyJerk_m_s3 = std::numeric_limits<double>::infinity();

  /// Starts at rest in the middle.  @throws stillhand::ConfigError when a limit is out of range.
  explicit PlatformGuard(const PlatformLimits& limits, double most_jerk_m_s3 = kAnyJerk_m_s3);

  /// Goes on from there, at rest.  @param position_m  within the travel, or nothing is done
  void stand_at(double position_m) noexcept;

  /// One tick.  Flags: kWorkspaceLimit when a command was shaped, kInputStale when the command is
  /// missing, kInputInvalid when it is NaN or infinite.
  PlatformCommand step(const GuardInput& input) noexcept;

  /// The last output.
  [[nodiscard]] const PlatformCommand& state() const noexcept { return state_; }
  [[nodiscard]] const PlatformLimits& limits() const noexcept { return limits_; }

 private:
  [[nodiscard]] bool reachable(const PlatformCommand& next) const noexcept;
  [[nodiscard]] double approach_velocity(const PlatformCommand& clipped) const noexcept;
  [[nodiscard]] double braking_velocity() const noexcept;
  [[nodiscard]] double highest_velocity(double gap_m, double velocity_m_s) const noexcept;
  [[nodiscard]] double least_braking_m_s2() const noexcept;
  [[nodiscard]] double smoothed(double velocity_m_s) const noexcept;
  void move(double velocity_m_s) noexcept;

  PlatformLimits limits_;
  double most_jerk_m_s3_;
  PlatformCommand state_;
  PlatformCommand asked_;  // the previous command, clipped to the limits
  bool asked_before_ = false;
};

}  // namespace stillhand::motion
