// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/record/measurement.hpp"
#include "tests/planted/recording.hpp"

namespace stillhand::planted {

/// Converts the recording to the input type of the engine.  Linear interpolation fills up to five
/// consecutive missing rows, with weight zero; a longer gap begins a new stretch.
diagnosis::Measurement to_measurement(const Recording& recording);

}  // namespace stillhand::planted
