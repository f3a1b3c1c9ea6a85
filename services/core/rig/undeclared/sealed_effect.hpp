// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace stillhand::rig {

struct RigConfig;
class UndeclaredEffect;

/// Facts of an opened effect.
struct OpenedEffect {
  struct Parameter {
    std::string name;
    std::string unit;
    double value;
  };
  std::uint64_t seed = 0;
  std::string kind = "none";  ///< a kind of the residual engine, one outside of it, or "none"
  std::string channel;        ///< channel of the effect; empty: none
  std::string place;          ///< place in the rig at which it acts
  std::vector<Parameter> parameters;
};

/// What a seed draws from.
enum class EffectSource : std::uint8_t {
  kKinds,         ///< kinds of the residual engine, or none
  kOutsideKinds,  ///< effects that none of its kinds describes
};

/// An effect that only the rig knows; README, "The undeclared effect".  The constructor draws it
/// from the seed.  It moves into a Rig and can be opened once; a rig with an opened effect must not
/// step again.  There is no other access: only the core of the rig knows the type.  The same seed
/// and settings give the same effect.
class SealedEffect {
 public:
  /// No effect.
  SealedEffect() noexcept;
  /// @param seed       0: no effect
  /// @param sized_for  the rig whose feedthrough is the reference of the size; the effect may act
  ///                   in another rig
  /// @throws ConfigError if a field of `sized_for` is out of range.
  SealedEffect(std::uint64_t seed, const RigConfig& sized_for,
               EffectSource source = EffectSource::kKinds);
  ~SealedEffect();
  SealedEffect(SealedEffect&&) noexcept;
  SealedEffect& operator=(SealedEffect&&) noexcept;

  /// Returns the facts and removes the effect.
  [[nodiscard]] OpenedEffect open() &&;

 private:
  friend class Rig;
  std::unique_ptr<UndeclaredEffect> effect_;
};

}  // namespace stillhand::rig
