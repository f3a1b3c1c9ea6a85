// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <numbers>
#include <string>
#include <string_view>

#include "services/core/contract/config_error.hpp"
#include "services/core/device_rig/devices_config.hpp"
#include "services/core/device_rig/drive_protocol.hpp"
#include "services/core/device_rig/parts.hpp"
#include "services/core/rig/rig.hpp"
#include "services/devices/device_rig/platform_drive.hpp"

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

/// Those of the simulated platform, as far as motion's guard knows them: no command of motion is
/// beyond its ranges.  A plain platform that got no packet for `valid_ms` braked by itself, so its
/// newest reply must be younger while it follows.
/// @throws ConfigError where an exchange takes longer than the oldest reply that counts
inline PlatformDrive::Limits platform_limits(const rig::PlatformConfig& config,
                                             const PlatformLinkConfig& link,
                                             Parts::Platform protocol) {
  motion::PlatformLimits guard{.max_position_m = config.workspace_m,
                               .max_velocity_m_s = config.max_velocity_m_s,
                               .max_acceleration_m_s2 = config.max_acceleration_m_s2,
                               .stop_acceleration_m_s2 = config.stop_deceleration_m_s2};
  motion::PlatformLimits::fields(
      [](std::string_view, double& value, Range range, std::string_view) {
        value = std::clamp(value, range.min, range.max);
      },
      guard);
  const bool plain = protocol == Parts::Platform::kPlain;
  const Tick following = plain ? std::min(link.max_age_ticks, link.valid_ms) : link.max_age_ticks;
  if (protocol != Parts::Platform::kSimulated && link.period_ticks >= following) {
    throw ConfigError("devices.platform.period_ticks", std::to_string(link.period_ticks),
                      "less than max_age_ticks and, of the plain protocol, valid_ms");
  }
  return {.guard = guard,
          .most_jerk_m_s3 = link.max_jerk_m_s3,
          .most_age_ticks = link.max_age_ticks,
          .most_following_age_ticks = following};
}

}  // namespace stillhand::device_rig
