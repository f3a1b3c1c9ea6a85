// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A sinusoid in time that no channel has:
///
///   c sin(2 pi f t) + c' cos(2 pi f t)
///
/// Source: METHOD Eq. DG-31.
const EffectKind& tone_kind();

}  // namespace stillhand::diagnosis
