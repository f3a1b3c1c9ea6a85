// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/diagnosis/core/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A force periodic in a position, README Eq. DG-30.
const EffectKind& position_ripple_kind();

}  // namespace stillhand::diagnosis
