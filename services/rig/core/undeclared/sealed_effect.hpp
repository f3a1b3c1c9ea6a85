// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace stillhand::rig {

struct RigConfig;
class UndeclaredEffect;

/// What a sealed effect was, once it is opened.
struct OpenedEffect {
  struct Parameter {
    std::string name;
    std::string unit;
    double value;
  };
  std::uint64_t seed = 0;
  std::string kind = "none";  ///< as the residual engine names it, or "none"
  std::string channel;        ///< the channel that goes with it; empty: none does
  std::string place;          ///< where in the rig it acts
  std::vector<Parameter> parameters;
};

/// An effect that the rig holds and nothing else is told of, README "The undeclared effect".  It is
/// drawn from its seed, moves into a Rig, and can be opened once; a rig whose effect was opened
/// steps no more.  What it is can't be asked in any other way: its type is known to the rig's core
/// alone.  The same seed and settings give the same effect.
class SealedEffect {
 public:
  /// Nothing in it.
  SealedEffect() noexcept;
  /// @param seed       0: nothing in it
  /// @param sized_for  the rig whose feedthrough its size is a share of; it may act in another
  /// @throws ConfigError when a field of `sized_for` is out of range.
  SealedEffect(std::uint64_t seed, const RigConfig& sized_for);
  ~SealedEffect();
  SealedEffect(SealedEffect&&) noexcept;
  SealedEffect& operator=(SealedEffect&&) noexcept;

  /// What it was; the effect is gone.
  [[nodiscard]] OpenedEffect open() &&;

 private:
  friend class Rig;
  std::unique_ptr<UndeclaredEffect> effect_;
};

}  // namespace stillhand::rig
