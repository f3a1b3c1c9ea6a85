// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A pure delay of the input that the body's poles and zeros do not provide:
///
///   u(t - d)
///
/// Source: METHOD Eq. DG-20, by the fractional delay of DG-2, Laakso et al. (1996).
const EffectKind& delay_kind();

}  // namespace stillhand::diagnosis
