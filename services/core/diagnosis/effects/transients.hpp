// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// Isolated bursts: the samples from the begin to the end of each have weight 0.
///
/// Source: METHOD Eq. DG-37.
const EffectKind& transients_kind();

}  // namespace stillhand::diagnosis
