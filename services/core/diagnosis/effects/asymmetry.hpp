// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A response that differs with the direction, an even function of a signal:
///
///   v + k |v| of input or output;  u + s (u^2/u_m - u) of the input;  |v| of the output;
///   feedback of |z| or z^2 inside the body;  c (x - m)^2 of a channel
///
/// Source: METHOD Eq. DG-25; bilinear and quadratic stiffness: Worden and Tomlinson (2001).
const EffectKind& asymmetry_kind();

}  // namespace stillhand::diagnosis
