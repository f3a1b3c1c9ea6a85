// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>

#include "services/core/rig/parts/band_noise.hpp"
#include "services/core/rig/parts/chain_effect.hpp"
#include "services/core/rig/parts/platform.hpp"
#include "services/core/rig/undeclared/sealed_effect.hpp"
#include "services/core/signal/delay_line.hpp"

namespace stillhand::rig {

/// Numbers of a drawn effect; a number at its default has no effect.
struct EffectPlan {
  OpenedEffect facts;
  ChainEffect chain;  ///< Eq. RG-14 to RG-20, and friction RG-21

  double fore_aft_rms_m_s2 = 0.0;  ///< RG-22: the platform's own shaking in x
  double fore_aft_mass_kg = 0.0;   ///< force on the hand per a_x, signed
  double fore_aft_lag_s = 0.0;     ///< lag of that force; 0: none

  double roll_rms_rad = 0.0;   ///< RG-23
  double borne_mass_kg = 0.0;  ///< mass of the arm that the handle bears when the platform rolls

  double tone_n = 0.0;  ///< RG-24, amplitude
  double tone_hz = 0.0;
  double tone_phase_rad = 0.0;

  std::size_t cell_delay_ticks = 0;                               ///< RG-25
  std::size_t motor_delay_ticks = 0;                              ///< RG-25
  double cell_limit_n = std::numeric_limits<double>::infinity();  ///< RG-26
};

/// Bands of the additional platform motion, Eq. RG-22 and RG-23.
inline constexpr double kForeAftLow_hz = 0.5;
inline constexpr double kForeAftHigh_hz = 3.0;
inline constexpr double kRollLow_hz = 0.05;
inline constexpr double kRollHigh_hz = 0.3;

/// A drawn effect at 1 kHz.  It advances with the rig in which it acts.  The Body applies the part
/// inside the chain, on_chain().  The effect exceeds no limit: the motor envelope, the stops and
/// the range of the board act after it.
/// Source: METHOD Eq. RG-12 to RG-26.
/// Pure: no clock, no I/O; never allocates, locks or throws after construction.
class UndeclaredEffect {
 public:
  /// Contribution of the effect in one tick.
  struct Shaken {
    double accel_x_m_s2;  ///< of the platform, + forward
    double roll_rad;      ///< of the platform, + right side down
    double hand_n;        ///< on the hand, above the load cell, + right
  };

  explicit UndeclaredEffect(const EffectPlan& plan);

  [[nodiscard]] const OpenedEffect& facts() const noexcept { return plan_.facts; }
  [[nodiscard]] const ChainEffect& on_chain() const noexcept { return plan_.chain; }

  Shaken step(const PlatformState& platform) noexcept;
  /// The motor force after the delay of Eq. RG-25.  @param usable  a finite command is present
  double motor_force(double wanted_n, bool usable) noexcept;
  /// The reading of the load cell, Eq. RG-25 and RG-26.
  double cell_force(double force_n) noexcept;

 private:
  double gate(const PlatformState& platform) noexcept;

  EffectPlan plan_;
  BandNoise fore_aft_;
  BandNoise roll_;
  double lag_blend_;
  double lagged_m_s2_ = 0.0;
  double tone_step_rad_;
  double tone_rad_;
  int still_ticks_;
  double gate_ = 0.0;
  signal::DelayLine cell_delay_;
  signal::DelayLine motor_delay_;
};

}  // namespace stillhand::rig
