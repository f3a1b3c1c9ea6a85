// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/diagnosis/core/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A pure delay of the input that the body's poles don't give, README Eq. DG-20.
const EffectKind& delay_kind();

}  // namespace stillhand::diagnosis
