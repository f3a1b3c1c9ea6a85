// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A curve whose shape the data alone give: straight between knots, level beyond the outer ones,
///
///   h(x) = sum_k c_k L_k(x),  L_k: 1 at knot k, 0 at every other knot
///
/// as a force h(x) or h(x) v, or as a factor 1 + h(x) on the body's output, x a channel or the
/// size of an input (its RMS over some seconds).  Or a smooth curve m(u) in place of the first
/// input.  When it is tried: Eq. DG-64.
///
/// Source: METHOD Eq. DG-63; Hastie, Tibshirani and Friedman (2009), section 5.2 (basis of linear
/// splines).
const EffectKind& free_form_kind();

}  // namespace stillhand::diagnosis
