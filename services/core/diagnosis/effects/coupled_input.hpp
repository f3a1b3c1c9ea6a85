// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A linear path from another channel:
///
///   c x;  c_1 x + c_2 x';  c times a first-order low-pass of x;  x through the body's poles
///
/// Source: METHOD Eq. DG-22.
const EffectKind& coupled_input_kind();

}  // namespace stillhand::diagnosis
