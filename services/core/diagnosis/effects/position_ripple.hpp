// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A force periodic in a position x, of spatial frequency k, with one or two harmonics (cogging):
///
///   sum_h c_h sin(2 pi h k x) + c'_h cos(2 pi h k x)
///
/// Source: METHOD Eq. DG-30.
const EffectKind& position_ripple_kind();

}  // namespace stillhand::diagnosis
