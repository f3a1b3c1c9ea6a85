// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "services/files/device_rig/calibration_file.hpp"
#include "services/system/process/stop.hpp"

namespace stillhand::calibrate {

struct CalibrateOptions {
  device_rig::CalibratedSignal signal = device_rig::CalibratedSignal::kForce;
  std::filesystem::path config;  ///< folder with rig.yaml, devices.yaml and sensing.yaml
  std::string person;
  std::string sensor;
  std::string known;  ///< empty: those of the signal
  double seconds = 2.0;
  double tolerance = 0.02;    ///< of the largest quantity
  double motion_m = 0.01;     ///< `platform`: largest distance from where it stands
  std::int64_t periods = 10;  ///< `platform`: of 2 s, that are measured
  double push_n = 1.0;        ///< `check`: weight, and largest force of the motor
  double step_m = 0.001;      ///< `check`: step of the platform
};

/// Guides a person through the steps, prints the result, and writes it into sensing.yaml and
/// calibration.yaml of the folder.
/// @returns exit status: 1 if the calibration cannot be used or was broken off; nothing is written
///          then
/// @throws ConfigError for settings, devices and quantities that do not fit
int run_calibrate(const CalibrateOptions& options, const runtime::Stop& interrupted);

}  // namespace stillhand::calibrate
