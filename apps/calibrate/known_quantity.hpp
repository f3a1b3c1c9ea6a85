// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/core/contract/units.hpp"
#include "services/files/device_rig/calibration_file.hpp"

namespace stillhand::calibrate {

/// Standard gravity [m/s^2]: the third CGPM, 1901.

/// "0,5,-0.5kg": quantities of a signal, separated by commas, each with the signal's unit or
/// another one: N or kg (a weight), m/s^2 or g, rad or deg.  Without a unit it is the signal's.
/// @returns N, m/s^2 or rad, + right
/// @throws ConfigError for a word that is no such quantity
std::vector<double> known_quantities(const std::string& words, device_rig::CalibratedSignal signal);

/// What a person does for a step, in one sentence.
std::string instruction(device_rig::CalibratedSignal signal, double known);

}  // namespace stillhand::calibrate
