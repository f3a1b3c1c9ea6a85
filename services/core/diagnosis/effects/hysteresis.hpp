// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A force that depends on the past of a displacement z, in units of a threshold:
///
///   w(n) = clip(w(n-1) + z(n) - z(n-1), 1)  or  dw = dz (1 - w sign dz)
///
/// Source: METHOD Eq. DG-26; Visintin (1994) for the first, Dahl (1968) for the second.
const EffectKind& hysteresis_kind();

}  // namespace stillhand::diagnosis
