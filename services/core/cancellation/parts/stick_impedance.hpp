// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/signal/growing_oscillation.hpp"

namespace stillhand::cancellation {

/// What the motor adds to the stick, stated at the hand.
struct ImpedanceConfig {
  double mass_kg = 0.0;
  double damping_n_s_m = 0.0;
  double stiffness_n_m = 0.0;
  double lever_m = 0.10;
};

/// Corner of the lag behind which the acceleration of the stick is taken [Hz]: a derivative of a
/// counted angle without one is noise.
inline constexpr double kInertiaCorner_hz = 10.0;

/// What neither a person nor a platform does with the stick: 8 to 40 Hz, 0.6 mm at the hand and
/// growing, or 1 mm.  Own choice, above the 6 Hz of a road, and below the 1.6 mm by which a motor
/// of 10 N shakes a free stick at 25 Hz.
inline constexpr signal::OscillationLimits kOscillation{
    .low_hz = 8.0, .high_hz = 40.0, .floor_rad = 0.006, .ceiling_rad = 0.01};

/// The motor as spring, damper and inertia on the stick, METHOD Eq. MI-2:
///
///   f = -(K x + B v + M v'),   x = lever theta,  v = lever omega,  v' behind a lag of 10 Hz
///
/// It needs no model of the person, and resists what the person wants as much as what shakes it.
/// With the delay and the filter of a sampled loop it is passive only up to some frequency;
/// passive_up_to_hz() of apps/study/mitigations/design.hpp states it.  A stick that nobody holds is
/// lighter than that loop bears: from some 45 N s/m or 1.1 kg on it oscillates, at 13 Hz where the
/// motor is at its bound.  make_impedance() ends the force for good when the stick does
/// (kOscillation).  The force has no bound of its own: the envelope follows. Pure; step() never
/// allocates or throws.
class StickImpedance {
 public:
  /// @throws stillhand::ConfigError unless all are finite, K and B not negative, M from 0 to
  ///         0.8 kg, K at most (B + 0.5 N s/m)/2 ms, and the lever positive.  The loop's delay
  ///         makes a free stick with a stiffer spring unstable.
  explicit StickImpedance(const ImpedanceConfig& config);

  /// @return the force wanted at the hand [N], + right
  double step(double theta_rad, double omega_rad_s) noexcept;

 private:
  ImpedanceConfig config_;
  double slow_m_s_ = 0.0;  ///< v behind the lag
};

}  // namespace stillhand::cancellation
