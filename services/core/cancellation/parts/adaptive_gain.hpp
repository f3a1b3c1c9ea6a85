// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "services/core/cancellation/explained_motion.hpp"

namespace stillhand::cancellation {

/// Follows gain and phase of the feedthrough force online, METHOD Eq. CC-10 to CC-13:
///
///   counter force = w_0 f^ + w_1 f^'/Omega,          Omega = 2 pi 1.2 rad/s
///   r_i = F P (f^, f^'/Omega),  e = F x              x = lever theta
///   dw/dt = R^-1 r e / T,       dR/dt = (r r' - R)/T_R
///
/// P is the hand's compliance (HandCompliance), F a band-pass around the motion.  The operator's
/// own motion is not correlated with a_y, so that on average only the part of the motion that f^
/// explains moves w.  w stops where f^ explains no more of it: at the least motion that these two
/// weights can reach.  That is less than the motion with w = 0 as long as the true P differs from
/// this one by less than 90 degrees in the band.  Where it differs by more, the motion exceeds that
/// without a motor, and the weights go to zero (Eq. CC-13).
/// Source: Widrow and Stearns, Adaptive Signal Processing, 1985 (filtered-x, LMS-Newton).
/// Pure; step() neither allocates nor throws.
class AdaptiveGain {
 public:
  using Pair = ExplainedMotion::Pair;

  /// Weights stay at 1 and 0.
  AdaptiveGain() = default;
  /// @param compliance  sound, see check_model()
  explicit AdaptiveGain(const HandCompliance& compliance) : motion_(compliance) {}

  /// One tick.
  /// @param predicted_n  f^
  /// @param theta_rad    stick angle
  /// @param acting       the motor's force is in full effect; only then weights move
  /// @return the force that the motor should take away [N]
  double step(double predicted_n, double theta_rad, bool acting) noexcept;

  /// Forgets all motion; the weights stay.
  void reset() noexcept;

  /// w_0, w_1 [-].
  [[nodiscard]] const Pair& weights() const noexcept { return weights_; }

 private:
  void adapt(const Pair& r, double e) noexcept;
  void back_off(const Pair& r, double e) noexcept;

  std::optional<ExplainedMotion> motion_;
  Quadrature quadrature_;  ///< of f^
  Pair weights_{1.0, 0.0};
  std::array<double, 3> power_{};  ///< R_00, R_01, R_11 [m^2]
  double moved_ = 0.0;             ///< mean of e^2 [m^2]
  double unmoved_ = 0.0;           ///< the same without a motor, by P [m^2]
};

}  // namespace stillhand::cancellation
