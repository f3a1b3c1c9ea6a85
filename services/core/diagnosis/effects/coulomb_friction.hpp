// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A force with the sign of a rate:
///
///   c sign(v)  or  c tanh(v / v_t)
///
/// Source: METHOD Eq. DG-23; Worden and Tomlinson (2001).
const EffectKind& coulomb_friction_kind();

}  // namespace stillhand::diagnosis
