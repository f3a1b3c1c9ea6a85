// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// An input that reaches the body only up to a limit L:
///
///   clip(u_1, L)  or  L tanh(u_1 / L)
///
/// Source: METHOD Eq. DG-29; a static map before a linear system: Schoukens and Ljung (2019).
const EffectKind& input_saturation_kind();

}  // namespace stillhand::diagnosis
