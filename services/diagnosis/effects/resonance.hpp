// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/diagnosis/core/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A mode beyond the body's order, README Eq. DG-21.
const EffectKind& resonance_kind();

}  // namespace stillhand::diagnosis
