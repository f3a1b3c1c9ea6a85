// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/cancellation/control_model.hpp"
#include "services/core/signal/second_order_lag.hpp"

namespace stillhand::cancellation {

/// Takes the predicted feedthrough off the command instead of off the hand, METHOD Eq. CC-5:
///
///   M x'' + B x' + K x = f_hat,   theta_clean = theta - x / r
///
/// The hand is shaken as before; the command that the machine gets is not.  No force acts, so
/// there is nothing to bound.
/// Source: paper section V, "a model-based filter rather than controller acting through a motor".
/// Pure; step() never allocates or throws.
class CommandFilter {
 public:
  /// @throws stillhand::ConfigError unless M, K and r are positive and 0 < B < 2 sqrt(K M).
  explicit CommandFilter(const HandCompliance& hand);

  /// @param theta_rad          stick angle, + right
  /// @param predicted_force_n  f_hat of the canceller at this tick, + right
  /// @return the angle without what the platform's motion put into it [rad]
  double step(double theta_rad, double predicted_force_n) noexcept {
    return theta_rad - lag_.step(predicted_force_n * compliance_m_n_).x / lever_m_;
  }

 private:
  double compliance_m_n_;
  double lever_m_;
  signal::SecondOrderLag lag_;
};

}  // namespace stillhand::cancellation
