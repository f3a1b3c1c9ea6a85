// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/diagnosis/core/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A force that depends on where a displacement came from, README Eq. DG-26.
const EffectKind& hysteresis_kind();

}  // namespace stillhand::diagnosis
