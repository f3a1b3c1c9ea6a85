// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/calibrate/calibrate.hpp"

namespace stillhand::calibrate {

/// `stillhand calibrate check`: signs, scales and travel with the hand off (Eq. DR-19), as far as
/// the parts are devices.  The motor is armed for two pushes of at most `push_n`, from zero and
/// where the stick stands; the platform makes steps of `step_m`.  Writes what was seen into
/// calibration.yaml.
/// @returns as run_calibrate()
int run_hand_off_check(const CalibrateOptions& options, const runtime::Stop& interrupted);

}  // namespace stillhand::calibrate
