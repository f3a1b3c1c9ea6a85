// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "services/core/contract/tick.hpp"
#include "services/core/contract/trial.hpp"
#include "services/core/motion/motion_trajectory.hpp"
#include "services/core/motion/platform_command.hpp"
#include "services/core/motion/platform_guard.hpp"
#include "services/core/signal/growing_oscillation.hpp"
#include "services/core/vehicle/vehicle.hpp"

namespace stillhand::vehicle {

/// Event of a trial in which the stick drives; the trial's number follows.
inline constexpr std::string_view kDrivenEvent = "the stick drives the platform in trial ";

/// Settings of the process in the place of the motion process.
struct DrivenConfig {
  motion::PlatformLimits limits;  ///< of motion.yaml
  VehicleConfig vehicle;
  signal::OscillationLimits oscillation;
};

/// The stick at one tick of the sample clock.
struct StickSample {
  Tick tick = 0;
  double theta_rad = 0.0;
  bool sound = false;  ///< no flag says that the angle is invalid or stale
};

/// The platform under the vehicle: one command for each sample of the stick, for kLead_ticks later.
/// In a driven trial the vehicle moves it, in another one the trial's trajectory, outside of a
/// trial nothing.  Every command passes the guard of the motion process (Eq. MO-1 to MO-5), so it
/// keeps within travel, speed and acceleration whatever the stick does. Where the stick's
/// oscillation grows (Eq. VH-6 to VH-8), the drive ends: from then on the guard has no command, so
/// the platform brakes and stands (Eq. MO-4), every command carries kFault, and ended() stays true
/// until another trial is armed. step() never allocates, locks or throws; one thread.
class DrivenMotion {
 public:
  /// @throws stillhand::ConfigError when a setting is out of range.
  explicit DrivenMotion(const DrivenConfig& config);

  /// Another trial: the vehicle starts from rest, the detector without a finding.
  /// @param driven  the stick drives; otherwise the trajectory moves the platform.  It is swapped
  ///                with the one before, so that nothing is freed here.
  void arm(motion::MotionTrajectory&& trajectory, const Trial& trial, bool driven) noexcept;
  /// The session announces a trial: the one that is armed begins at its start; in place of another
  /// one, which is over, the platform returns to the middle, after an ended drive it stands.
  void announce(const Trial& trial) noexcept {
    if (trial.number != trial_.number) trial_ = Trial{};
    trial_.start_tick = trial.start_tick;
  }

  /// The command for `sample.tick + kLead_ticks`.  Call it for each tick in turn; a lost sample is
  /// one that is not sound.
  motion::PlatformCommand step(const StickSample& sample) noexcept;

  /// The drive was ended by the detector.
  [[nodiscard]] bool ended() const noexcept { return ended_; }
  [[nodiscard]] const signal::GrowingOscillation& oscillation() const noexcept {
    return oscillation_;
  }

 private:
  [[nodiscard]] double share(Tick tick) const noexcept;

  motion::PlatformGuard guard_;
  Vehicle vehicle_;
  signal::GrowingOscillation oscillation_;
  motion::MotionTrajectory trajectory_;
  Trial trial_;
  bool driven_ = false;
  bool ended_ = false;
};

}  // namespace stillhand::vehicle
