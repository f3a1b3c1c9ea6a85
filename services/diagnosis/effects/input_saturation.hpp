// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/diagnosis/core/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// An input that reaches the body only up to a limit, README Eq. DG-29.
const EffectKind& input_saturation_kind();

}  // namespace stillhand::diagnosis
