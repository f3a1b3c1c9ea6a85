// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/rig/core/undeclared/undeclared_effect.hpp"

namespace stillhand::rig {

struct RigConfig;

/// Kind and size of the effect of a seed: README "The undeclared effect", which has the table of
/// kinds, ranges and sources.  One seed in ten has none, the others every kind alike.
/// @param seed       not 0
/// @param sized_for  the rig against whose force the sizes are measured, Eq. RG-12
/// @throws ConfigError when one of its fields is out of range.
EffectPlan draw_effect(std::uint64_t seed, const RigConfig& sized_for);

}  // namespace stillhand::rig
