// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

#include "services/device_rig/core/devices_config.hpp"
#include "services/device_rig/core/drive_protocol.hpp"
#include "services/device_rig/core/set_point_guard.hpp"
#include "services/rig/core/rig.hpp"

namespace stillhand::device_rig {

/// The drive has a lag, a gain and a current limit of its own; what stays of the simulated motor is
/// its barrier.  A lag of 0 is out of the settings' range: 0.7 % of a step is left after one tick.
inline rig::MotorConfig barrier(rig::MotorConfig config) {
  config.lag_s = 0.0002;
  config.delay_s = 0.0;
  config.gain = 1.0;
  config.torque_constant_n_m_a = 1.0;
  config.capstan_ratio = 50.0;
  config.current_limit_a = 40.0;
  return config;
}

/// What the drive's own settings must be on this stick.
inline SettingLimits setting_limits(const rig::RigConfig& rig, const DevicesConfig& devices) {
  return {.max_current_a = devices.drive.max_current_a,
          .travel_rev = rig.stick.stop_angle_rad / (2.0 * std::numbers::pi)};
}

/// Those of the simulated platform.
inline SetPointLimits set_point_limits(const rig::PlatformConfig& config) {
  return {.workspace_m = config.workspace_m,
          .max_velocity_m_s = config.max_velocity_m_s,
          .max_acceleration_m_s2 = config.max_acceleration_m_s2,
          .catch_velocity_m_s = config.catch_velocity_m_s,
          .stop_deceleration_m_s2 = config.stop_deceleration_m_s2};
}

}  // namespace stillhand::device_rig
