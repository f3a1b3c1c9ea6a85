// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "services/device_rig/calibration_file.hpp"
#include "services/runtime/process/stop.hpp"

namespace stillhand::calibrate {

struct CalibrateOptions {
  device_rig::CalibratedSignal signal = device_rig::CalibratedSignal::kForce;
  std::filesystem::path config;  ///< folder with rig.yaml, devices.yaml and sensing.yaml
  std::string person;
  std::string sensor;
  std::string known;  ///< empty: those of the signal
  double seconds = 2.0;
  double tolerance = 0.02;  ///< of the largest quantity
};

/// Guides a person through the steps, prints the result, and writes it into sensing.yaml and
/// calibration.yaml of the folder.
/// @returns exit status: 1 if the calibration cannot be used or was broken off; nothing is written
///          then
/// @throws ConfigError for settings, devices and quantities that do not fit
int run_calibrate(const CalibrateOptions& options, const runtime::Stop& interrupted);

}  // namespace stillhand::calibrate
