// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "services/files/device_rig/calibration_file.hpp"

namespace stillhand::calibrate {

/// Writes calibration.yaml of a folder, and numbers into its sensing.yaml: both or neither.
/// @throws ConfigError for numbers that sensing does not accept
void write_calibrations(const std::filesystem::path& config, const device_rig::Calibrations& all,
                        const std::vector<device_rig::SensingNumber>& numbers = {});

}  // namespace stillhand::calibrate
