// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/diagnosis/core/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A slow additive change, README Eq. DG-32.
const EffectKind& drift_kind();

}  // namespace stillhand::diagnosis
