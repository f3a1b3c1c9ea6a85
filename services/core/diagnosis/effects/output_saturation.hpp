// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// An output that ends at a limit L, or at an upper and a lower one:
///
///   clip(y, L)  or  L tanh(y / L)
///
/// Source: METHOD Eq. DG-28; a static map behind a linear system: Schoukens and Ljung (2019).
const EffectKind& output_saturation_kind();

}  // namespace stillhand::diagnosis
