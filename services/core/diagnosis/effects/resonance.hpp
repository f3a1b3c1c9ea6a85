// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A mode beyond the body's order, of frequency f and damping ratio z, for each input u_k:
///
///   (c_k,1 D + c_k,2) x_k,  x_k = u_k / (1 - 2 r cos(w sqrt(1 - z^2)) q^-1 + r^2 q^-2),
///   r = e^(-z w),  w = 2 pi f T
///
/// Source: METHOD Eq. DG-21.
const EffectKind& resonance_kind();

}  // namespace stillhand::diagnosis
