// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/core/rig/undeclared/undeclared_effect.hpp"

namespace stillhand::rig {

struct RigConfig;

/// Draws an effect that no kind of the residual engine describes: near the threshold of detection
/// or far above it.  Every seed has one.
/// Source: METHOD, "Outside of the kinds", Eq. RG-33 to RG-36.
/// @param seed       not 0
/// @param sized_for  as draw_effect()
/// @throws ConfigError if one of its fields is out of range.
EffectPlan draw_outside(std::uint64_t seed, const RigConfig& sized_for);

}  // namespace stillhand::rig
