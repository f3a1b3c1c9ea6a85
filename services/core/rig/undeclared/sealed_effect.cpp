// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/undeclared/sealed_effect.hpp"

#include "services/core/rig/parts/rig_config.hpp"
#include "services/core/rig/undeclared/effect_draw.hpp"
#include "services/core/rig/undeclared/outside_draw.hpp"
#include "services/core/rig/undeclared/undeclared_effect.hpp"

namespace stillhand::rig {

SealedEffect::SealedEffect() noexcept = default;
SealedEffect::~SealedEffect() = default;
SealedEffect::SealedEffect(SealedEffect&&) noexcept = default;
SealedEffect& SealedEffect::operator=(SealedEffect&&) noexcept = default;

SealedEffect::SealedEffect(std::uint64_t seed, const RigConfig& sized_for, EffectSource source) {
  if (seed == 0) return;
  effect_ = std::make_unique<UndeclaredEffect>(source == EffectSource::kKinds
                                                   ? draw_effect(seed, sized_for)
                                                   : draw_outside(seed, sized_for));
}

OpenedEffect SealedEffect::open() && {
  if (!effect_) return {};
  OpenedEffect facts = effect_->facts();
  effect_.reset();
  return facts;
}

}  // namespace stillhand::rig
