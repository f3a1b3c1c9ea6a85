// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/diagnosis/core/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// An output that ends at a limit, README Eq. DG-28.
const EffectKind& output_saturation_kind();

}  // namespace stillhand::diagnosis
