// SPDX-License-Identifier: Apache-2.0
#pragma once

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

/// The motor as spring, damper and inertia on the stick, METHOD Eq. MI-2:
///
///   f = -(K x + B v + M v'),   x = lever theta,  v = lever omega,  v' behind a lag of 10 Hz
///
/// It needs no model of the person, and resists what the person wants as much as what shakes it.
/// With the delay and the filter of a sampled loop it is passive only up to some frequency;
/// passive_up_to_hz() of design.hpp states it.  The force has no bound of its own: the envelope
/// follows. Pure; step() never allocates or throws.
class StickImpedance {
 public:
  /// @throws stillhand::ConfigError unless all are finite, K and B not negative, |M| <= 2 kg and
  ///         the lever positive.
  explicit StickImpedance(const ImpedanceConfig& config);

  /// @return the force wanted at the hand [N], + right
  double step(double theta_rad, double omega_rad_s) noexcept;
  void reset() noexcept { slow_m_s_ = 0.0; }

 private:
  ImpedanceConfig config_;
  double slow_m_s_ = 0.0;  ///< v behind the lag
};

}  // namespace stillhand::cancellation
