// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A gain of the body's output that changes slowly over the record's length L:
///
///   g = 1 + c (2 t/L - 1);  1 + sum_{k=1..4} c_k cos(pi k t/L);  1 + s sin + c cos of 2 pi m t/L
///
/// Source: METHOD Eq. DG-33.
const EffectKind& time_varying_gain_kind();

}  // namespace stillhand::diagnosis
