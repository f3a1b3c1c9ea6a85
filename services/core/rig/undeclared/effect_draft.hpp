// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "services/core/rig/parts/rig_config.hpp"
#include "services/core/rig/undeclared/effect_sizing.hpp"
#include "services/core/rig/undeclared/undeclared_effect.hpp"
#include "services/core/signal/random.hpp"

namespace stillhand::rig {

/// A plan that is being drawn: numbers, names and sizes.
class EffectDraft {
 public:
  /// @param stream  of the seed
  EffectDraft(std::uint64_t seed, std::uint64_t stream, const RigConfig& sized_for)
      : engine_(seed, stream), rig_(sized_for) {
    plan_.facts.seed = seed;
  }

 protected:
  double uniform() { return engine_.uniform(); }
  double between(double low, double high) { return low + (high - low) * uniform(); }
  bool coin() { return uniform() < 0.5; }

  const PeggedTrial& pegged() {
    if (!pegged_) pegged_.emplace(rig_.body, rig_.stick);
    return *pegged_;
  }
  void name(const char* kind, const char* channel, const char* place) {
    plan_.facts.kind = kind;
    plan_.facts.channel = channel;
    plan_.facts.place = place;
  }
  void note(const char* what, const char* unit, double value) {
    plan_.facts.parameters.push_back({what, unit, value});
  }
  /// Sets a number of the chain's effect so that Eq. RG-12 gives `wanted`, and notes both.
  /// @return the share that it gives
  double size_chain(double ChainEffect::* number, Range range, double wanted, const char* what,
                    const char* unit) {
    const auto share = [&](double value) {
      ChainEffect effect = plan_.chain;
      effect.*number = value;
      return pegged().share(effect);
    };
    plan_.chain.*number = sized(range.min, range.max, wanted, share);
    note(what, unit, plan_.chain.*number);
    const double given = pegged().share(plan_.chain);
    note("share_of_force_rms", "-", given);
    return given;
  }

  signal::Gaussian engine_;
  const RigConfig& rig_;
  EffectPlan plan_;

 private:
  std::optional<PeggedTrial> pegged_;
};

}  // namespace stillhand::rig
