// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/contract/flag.hpp"
#include "services/contract/tick.hpp"
#include "services/rig/core/body_config.hpp"
#include "services/rig/core/chain.hpp"
#include "services/rig/core/undeclared/chain_effect.hpp"

namespace stillhand::rig {

/// Body and stick together, README Eq. RG-3 to RG-5; coordinates relative to the platform, + right.
/// The linear part is discretised exactly (Eq. RG-10); friction, stops and peg are forces found
/// implicitly at the end of the tick, so that they never put energy in.
/// Pure: no clock, no I/O; never allocates or throws after construction.
class Body {
 public:
  struct Input {
    double acceleration_m_s2;   ///< a_y of the platform at this tick
    double motor_force_n;       ///< at the hand, held over the tick that ends here
    double volitional_force_n;  ///< same
    bool pegged;                ///< also: the hand is idle, muscles relaxed
    double shaken_n = 0.0;      ///< on the hand, neither by the chain nor willed, Eq. RG-12; held
  };
  struct Output {
    double theta_rad;            ///< stick angle
    double omega_rad_s;          ///< stick rate
    double feedthrough_force_n;  ///< f'_b, Eq. RG-6: the body's force with the stick held at 0
    double hand_force_n;         ///< through the load cell, Eq. RG-5
    Flags flags;                 ///< kAtStop
  };

  /// @param period_s  length of a tick [s]; other than 1 ms only to study the discretisation
  /// @param effect    what the chain lacks, Eq. RG-13; nothing by default
  /// @throws stillhand::ConfigError when a field is outside its range.
  Body(const BodyConfig& body, const StickConfig& stick, double period_s = kControlPeriod_s,
       const ChainEffect& effect = {});

  Output step(const Input& input) noexcept;

  /// Kinetic plus elastic energy of chain and stick, stops left out [J].
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
  static Muscles muscles(const BodyConfig& body, const StickConfig& stick, bool relaxed,
                         double period_s);

  double move(const Input& input, const Muscles& chain, Flags& flags) noexcept;
  void stay(const Input& input, const Muscles& chain) noexcept;
  /// A tick of the chain with the stick held at 0, effect included.
  [[nodiscard]] HeldChain::State held_ahead(const HeldChain::State& from, double acceleration_m_s2,
                                            const Muscles& chain, EffectOnChain& effect) noexcept;
  /// Load-cell force of a held stick with the chain at `x`, Eq. RG-5.
  [[nodiscard]] static double held_force(const HeldChain::State& x, const Input& input,
                                         const ChainParameters& p, const EffectOnChain& effect);
  /// Velocity at the end of the tick on the critically damped way to the centre.
  [[nodiscard]] double seating_velocity() const noexcept;
  /// Force of the rubber on a stick that would be at `ahead` without it, Eq. RG-4.
  [[nodiscard]] double stop_force(const FreeChain::State& ahead,
                                  const FreeChain& chain) const noexcept;
  void end_at_steel() noexcept;

  StickConfig stick_;
  double period_s_;
  double stop_m_;        ///< where the rubber begins, at the hand
  double seating_keep_;  ///< exp(-dt / peg_seat_time)
  double friction_n_;    ///< F_c and what the effect adds
  Muscles relaxed_;
  Muscles tense_;
  EffectOnChain effect_;       ///< on x_
  EffectOnChain copy_effect_;  ///< on copy_
  FreeChain::State x_{};       ///< trunk, arm, stick
  HeldChain::State copy_{};    ///< trunk and arm, had the stick been held at 0 all the time
  double last_acceleration_m_s2_ = 0.0;
  bool pegged_ = false;
  bool seated_ = false;  ///< the peg holds the stick at exactly 0
};

}  // namespace stillhand::rig
