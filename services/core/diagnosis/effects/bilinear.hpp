// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A product of two channels, or a gain that follows a channel:
///
///   c (x_1 - m_1)(x_2 - m_2);  g = 1 + s (x - m) on the body's output
///
/// Source: METHOD Eq. DG-36.
const EffectKind& bilinear_kind();

}  // namespace stillhand::diagnosis
