// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/core/rig/undeclared/undeclared_effect.hpp"

namespace stillhand::rig {

struct RigConfig;

/// Draws kind and size of the effect of a seed.  One seed in ten has no effect; the others draw
/// each row of the table with equal probability.
/// Source: METHOD, "The undeclared effect" (kinds, ranges, sources).
/// @param seed       not 0
/// @param sized_for  the rig whose force is the reference of the sizes, Eq. RG-12
/// @throws ConfigError if one of its fields is out of range.
EffectPlan draw_effect(std::uint64_t seed, const RigConfig& sized_for);

}  // namespace stillhand::rig
