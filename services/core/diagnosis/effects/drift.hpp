// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A slow additive change, L the length of the record:
///
///   c (t/L - 1/2);  c e^(-t/tau);  sum_{k=1..3} c_k cos(pi k t/L)
///
/// Source: METHOD Eq. DG-32.
const EffectKind& drift_kind();

}  // namespace stillhand::diagnosis
