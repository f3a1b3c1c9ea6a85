// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// Play: nothing happens within a range of half width h:
///
///   x - clip(x, h) of input, output or a position;  feedback of clip(z, 1) inside the body
///
/// Source: METHOD Eq. DG-27; piecewise linear stiffness: Worden and Tomlinson (2001).
const EffectKind& dead_zone_kind();

}  // namespace stillhand::diagnosis
