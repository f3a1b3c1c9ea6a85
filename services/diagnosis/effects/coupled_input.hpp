// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/diagnosis/core/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A linear path from another channel, README Eq. DG-22.
const EffectKind& coupled_input_kind();

}  // namespace stillhand::diagnosis
