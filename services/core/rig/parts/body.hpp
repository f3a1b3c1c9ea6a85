// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/core/contract/flag.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/rig/parts/body_config.hpp"
#include "services/core/rig/parts/chain.hpp"
#include "services/core/rig/parts/chain_effect.hpp"
#include "services/core/rig/parts/neuromuscular.hpp"

namespace stillhand::rig {

/// Body and stick together; coordinates relative to the platform, + right.
/// Source: METHOD Eq. RG-3 to RG-5.  The discretisation of the linear part is exact (Eq. RG-10).
/// Friction, stops and peg are implicit forces at the end of the tick, so they never add energy.
/// Pure: no clock, no I/O; never allocates or throws after construction.
class Body {
 public:
  struct Input {
    double acceleration_m_s2;   ///< a_y of the platform at this tick
    double motor_force_n;       ///< at the hand, held over the tick that ends here
    double volitional_force_n;  ///< same
    bool pegged;                ///< the peg holds the stick; the hand is idle, muscles relaxed
    double shaken_n = 0.0;    ///< further force on the hand, Eq. RG-22 to RG-24, RG-31, RG-32; held
    int stiffness_level = 0;  ///< of StiffnessLevels, Eq. RG-27 and RG-28
  };
  struct Output {
    double theta_rad;            ///< stick angle
    double omega_rad_s;          ///< stick rate
    double feedthrough_force_n;  ///< f'_b, Eq. RG-6: the body's force with the stick held at 0
    double hand_force_n;         ///< through the load cell, Eq. RG-5
    Flags flags;                 ///< kAtStop
  };

  /// @param period_s  length of a tick [s]; other values than 1 ms only study the discretisation
  /// @param effect    effect that the chain lacks, Eq. RG-13; none by default
  /// @throws stillhand::ConfigError if a field is outside its range.
  Body(const BodyConfig& body, const StickConfig& stick, double period_s = kControlPeriod_s,
       const ChainEffect& effect = {});

  Output step(const Input& input) noexcept;

  /// Kinetic plus elastic energy of chain and stick, without the stops [J].
  [[nodiscard]] double energy_j() const noexcept;

 private:
  /// Everything that changes when the hand relaxes.
  struct Muscles {
    ChainParameters parameters;
    FreeChain free;
    HeldChain held;
    ForceColumns<6> free_forces;
    ForceColumns<4> held_forces;
  };
  /// By stiffness level from kLowest on; one where the body's stiffness never changes.
  /// @param pushed  false: nothing pushes trunk or arm, and the columns of such forces stay 0
  static std::vector<Muscles> muscles(const BodyConfig& body, const StickConfig& stick,
                                      bool relaxed, double period_s, bool pushed);
  /// Of the present state of the peg and the present level.
  [[nodiscard]] const Muscles& muscles_now() const noexcept;

  double move(const Input& input, const Muscles& chain, Flags& flags) noexcept;
  void stay(const Input& input, const Muscles& chain) noexcept;
  /// What acts on one chain besides its linear parts.
  struct Extra {
    EffectOnChain effect;
    Reflex reflex;
    [[nodiscard]] bool acts() const noexcept { return effect.acts() || reflex.acts(); }
  };
  /// A tick of the chain with the stick held at 0, effect and reflex included.
  [[nodiscard]] HeldChain::State held_ahead(const HeldChain::State& from, const Input& input,
                                            const Muscles& chain, Extra& extra) noexcept;
  /// Load-cell force of a held stick with the chain at `x`, Eq. RG-5.
  [[nodiscard]] static double held_force(const HeldChain::State& x, const Input& input,
                                         const ChainParameters& p, const EffectOnChain& effect);
  /// Velocity at the end of the tick on the critically damped path to the centre.
  [[nodiscard]] double seating_velocity() const noexcept;
  /// Force of the rubber on a stick; `ahead` is its state without this force, Eq. RG-4.
  [[nodiscard]] double stop_force(const FreeChain::State& ahead,
                                  const FreeChain& chain) const noexcept;
  void end_at_steel() noexcept;

  StickConfig stick_;
  double period_s_;
  double stop_m_;        ///< where the rubber begins, at the hand
  double seating_keep_;  ///< exp(-dt / peg_seat_time)
  double friction_n_;    ///< F_c plus the friction of the effect
  Extra extra_;          ///< on x_
  Extra copy_extra_;     ///< on copy_
  std::vector<Muscles> relaxed_;
  std::vector<Muscles> tense_;
  FreeChain::State x_{};     ///< trunk, arm, stick
  HeldChain::State copy_{};  ///< trunk and arm with the stick always held at 0
  double last_acceleration_m_s2_ = 0.0;
  bool pegged_ = false;
  int level_ = 0;        ///< of StiffnessLevels
  bool seated_ = false;  ///< the peg holds the stick at exactly 0
};

}  // namespace stillhand::rig
