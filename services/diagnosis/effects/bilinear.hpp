// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/diagnosis/core/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// A product of two channels, README Eq. DG-36.
const EffectKind& bilinear_kind();

}  // namespace stillhand::diagnosis
