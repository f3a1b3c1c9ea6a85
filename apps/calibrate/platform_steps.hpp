// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/calibrate/calibrate.hpp"

namespace stillhand::calibrate {

/// `stillhand calibrate platform`: moves the platform by a multisine around the place where it
/// stands, prints lag and bandwidth (Eq. DR-18), and writes them into calibration.yaml.  No motor
/// is armed.
/// @returns as run_calibrate()
int run_calibrate_platform(const CalibrateOptions& options, const runtime::Stop& interrupted);

}  // namespace stillhand::calibrate
