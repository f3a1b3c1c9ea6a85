// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "services/core/device_rig/devices_config.hpp"
#include "services/core/device_rig/drive_protocol.hpp"

namespace stillhand::device_rig {

/// The protocol of the drive that the settings name.  A new drive is a line here.
/// @throws ConfigError for a kind that is none
std::unique_ptr<DriveProtocol> protocol_of(const DriveConfig& config, const SettingLimits& limits);

}  // namespace stillhand::device_rig
