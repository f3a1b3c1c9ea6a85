// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// Clocks of input and output that run apart:
///
///   u(t - d (t - t_m)),  t_m the middle of the record
///
/// Source: METHOD Eq. DG-35, by the fractional delay of DG-2, Laakso et al. (1996).
const EffectKind& clock_drift_kind();

}  // namespace stillhand::diagnosis
