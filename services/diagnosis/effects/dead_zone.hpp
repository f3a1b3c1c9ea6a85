// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/diagnosis/core/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// Play: nothing happens within a range, README Eq. DG-27.
const EffectKind& dead_zone_kind();

}  // namespace stillhand::diagnosis
