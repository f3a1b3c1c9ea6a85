// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/admittance/arm_model.hpp"
#include "services/core/cancellation/parts/linear_arm.hpp"
#include "services/core/signal/band_pass.hpp"

namespace stillhand::cancellation {

/// The arms between which a schedule chooses, as fit_arm() gives them for two tasks.
struct ScheduleConfig {
  admittance::ArmValues relaxed{};
  admittance::ArmValues holding{};
  admittance::StickValues stick = {};
  double lever_m = 0.10;
  double memory_s = 10.0;  ///< T of Eq. MI-5
};

/// Feedthrough force of an arm between two known ones, METHOD Eq. MI-5:
///
///   x_i, f_i          stick's motion and held force that arm i predicts from a and f_m (MI-4)
///   d = F (x_1 - x_0),  y = F (x - x_0)              F: band-pass of 0.5 to 3 Hz, as CC-10
///   dR/dt = (d^2 - R)/T,  dq/dt = (d y - q)/T,   w = q/R within 0 .. 1
///   f^ = f_0 + w (f_1 - f_0)
///
/// Recursive least squares with forgetting, of one parameter: how far the arm is from the relaxed
/// to the holding one.  It starts at w = 1/2, held there by R and q of a motion of 0.2 mm.  x is
/// all it needs of the stick.  What the person wants is not correlated with a and averages out over
/// T.  The motor's force is part of the prediction, so a stick that is kept still by it says so.
/// Pure; step() never allocates or throws.
class ScheduledForce {
 public:
  /// @throws stillhand::ConfigError as LinearArm; unless lever and memory are positive.
  explicit ScheduledForce(const ScheduleConfig& config);

  /// @param motor_n  of the motor since the tick before
  /// @return f^ [N], + right
  double step(double accel_m_s2, double theta_rad, double motor_n) noexcept;

  /// w: 0 the relaxed arm, 1 the holding one.
  [[nodiscard]] double weight() const noexcept { return weight_; }

 private:
  LinearArm relaxed_;
  LinearArm holding_;
  double lever_m_;
  double forget_;  ///< 1 tick / T
  signal::BandPass of_difference_;
  signal::BandPass of_motion_;
  double power_;  ///< R [m^2]
  double cross_;  ///< q [m^2]
  double weight_ = 0.5;
};

}  // namespace stillhand::cancellation
