// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/diagnosis/core/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A response that differs with the direction, even, README Eq. DG-25.
const EffectKind& asymmetry_kind();

}  // namespace stillhand::diagnosis
