// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/contract/flag.hpp"
#include "services/device_rig/core/platform_protocol.hpp"

namespace stillhand::device_rig {

/// Bounds of what a platform is asked for; those of the rig's settings.
struct SetPointLimits {
  double workspace_m, max_velocity_m_s, max_acceleration_m_s2;
  double catch_velocity_m_s;      ///< approach to a distant command
  double stop_deceleration_m_s2;  ///< without a command
};

/// The last thing a platform's set-point passes, README Eq. DR-9: inside the workspace, slower than
/// the limits, without a step.  It begins where the platform is.  Without a command it brakes and
/// holds.  A command that is followed within the limits passes unchanged.
/// Pure; never allocates or throws.
class SetPointGuard {
 public:
  struct Output {
    SetPoint set_point;
    Flags flags;  ///< kInputStale (no command), kInputInvalid, kWorkspaceLimit
  };

  explicit SetPointGuard(const SetPointLimits& limits) : limits_(limits) {}

  /// One tick.  @param wanted  `follow` false: no command arrived for this tick
  Output step(const SetPoint& wanted) noexcept;
  /// The platform stands there; for the time before it follows.
  void stand_at(double position_m) noexcept;

 private:
  void brake() noexcept;

  SetPointLimits limits_;
  double position_m_ = 0.0;
  double velocity_m_s_ = 0.0;
};

}  // namespace stillhand::device_rig
