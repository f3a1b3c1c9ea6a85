// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/diagnosis/core/measurement.hpp"
#include "tests/planted/recording.hpp"

namespace stillhand::planted {

/// The recording as the engine takes it.  Up to five lost rows in a row are filled by straight
/// lines and weigh nothing; a longer gap begins a new stretch.
diagnosis::Measurement to_measurement(const Recording& recording);

}  // namespace stillhand::planted
