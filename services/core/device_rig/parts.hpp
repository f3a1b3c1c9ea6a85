// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "services/core/device_rig/devices_config.hpp"

namespace stillhand::device_rig {

/// Which parts of the rig are devices.  Made of the settings once; a word that is no part is a
/// ConfigError.
struct Parts {
  enum class Source : unsigned char { kSimulated, kDrive, kPlatform, kIio };
  enum class Motor : unsigned char { kSimulated, kDrive, kOff };
  enum class Platform : unsigned char { kSimulated, kPlain, kMoog };
  enum class Drive : unsigned char { kMoteus, kMoteusCan };

  Source acceleration, force, angle;
  Motor motor;
  Platform platform;
  Drive drive;  ///< which one, where a signal needs it

  [[nodiscard]] bool needs_drive() const noexcept {
    return acceleration == Source::kDrive || force == Source::kDrive || angle == Source::kDrive ||
           motor != Motor::kSimulated;
  }
  [[nodiscard]] bool any_device() const noexcept {
    return acceleration != Source::kSimulated || force != Source::kSimulated || needs_drive() ||
           needs_platform();
  }
  [[nodiscard]] bool needs_platform() const noexcept { return platform != Platform::kSimulated; }
};

/// @throws ConfigError for a word that names no part, a sign of 0, one analogue input for two
///         signals, or parts that do not fit
Parts parts_of(const DevicesConfig& config);

/// Which drive the settings mean.  @throws ConfigError for a word that names none
Parts::Drive drive_of(const DriveConfig& config);

/// Signal and part, for people and results: {"acceleration", "drive"}, ...
std::vector<std::pair<std::string, std::string>> named_parts(const SignalsConfig& signals);
/// "acceleration drive, force drive, ...; simulated: platform"
std::string in_words(const SignalsConfig& signals);

}  // namespace stillhand::device_rig
