// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A hardening or softening spring, an odd function of a displacement z in units of a threshold:
///
///   feedback of z^3, z^3/(1 + z^2) or z - tanh z inside the body;  y + k y^3 of the output;
///   c_1 (x - m) + c_2 (x - m)^3 of a position
///
/// Source: METHOD Eq. DG-24; cubic stiffness: Worden and Tomlinson (2001).
const EffectKind& nonlinear_stiffness_kind();

}  // namespace stillhand::diagnosis
