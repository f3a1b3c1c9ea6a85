// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/diagnosis/core/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A gain that changes at one moment, README Eq. DG-34.
const EffectKind& regime_change_kind();

}  // namespace stillhand::diagnosis
