// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "services/core/device_rig/devices_config.hpp"
#include "services/core/device_rig/drive_protocol.hpp"

namespace stillhand::device_rig::odrive {

/// Properties of an axis that are read back, DEVICES "The drive's settings".
std::span<const std::string_view> settings_of(std::size_t axis) noexcept;

/// @param text  the drive's answer to "r NAME"
/// @returns nothing if the setting is right
std::optional<SettingFault> judge_setting(std::string_view name, std::string_view text,
                                          const DriveConfig& config);

}  // namespace stillhand::device_rig::odrive
