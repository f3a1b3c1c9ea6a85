// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/diagnosis/core/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A hardening or softening spring, odd, README Eq. DG-24.
const EffectKind& nonlinear_stiffness_kind();

}  // namespace stillhand::diagnosis
