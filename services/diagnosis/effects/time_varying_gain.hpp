// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/diagnosis/core/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A gain that changes slowly over the record, README Eq. DG-33.
const EffectKind& time_varying_gain_kind();

}  // namespace stillhand::diagnosis
