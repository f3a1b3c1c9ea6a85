// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A gain of the body's output that changes at one moment t_0:
///
///   g = 1 - c before t_0, 1 + c after
///
/// Source: METHOD Eq. DG-34.
const EffectKind& regime_change_kind();

}  // namespace stillhand::diagnosis
