// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/diagnosis/core/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// Clocks of input and output that run apart, README Eq. DG-35.
const EffectKind& clock_drift_kind();

}  // namespace stillhand::diagnosis
