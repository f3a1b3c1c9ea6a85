// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "services/core/device_rig/parts.hpp"
#include "services/files/settings/load.hpp"
#include "services/files/settings/placed_error.hpp"

namespace stillhand::device_rig {

/// Settings of a rig made of devices whose parts fit.
/// @throws ConfigError that names the file and the key
inline DevicesConfig load_devices(const std::filesystem::path& file) {
  auto config = settings::load<DevicesConfig>(file, "devices");
  settings::placed(file.string(), [&] { return parts_of(config); });
  return config;
}

}  // namespace stillhand::device_rig
