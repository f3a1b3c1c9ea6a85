// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/diagnosis/core/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// Isolated bursts, README Eq. DG-37.
const EffectKind& transients_kind();

}  // namespace stillhand::diagnosis
