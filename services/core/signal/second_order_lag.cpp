// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/second_order_lag.hpp"

#include <cmath>

#include "services/core/contract/expects.hpp"

namespace stillhand::signal {

SecondOrderLag::SecondOrderLag(double natural_rad_s, double damping_ratio, double period_s)
    : w2_(natural_rad_s * natural_rad_s), damping_(2.0 * damping_ratio * natural_rad_s) {
  STILLHAND_EXPECTS(natural_rad_s > 0.0 && damping_ratio > 0.0 && damping_ratio < 1.0);
  // exp(A t) of the oscillator about u, with decay s and damped frequency d.
  const double decay_rad_s = damping_ratio * natural_rad_s;
  const double damped_rad_s = natural_rad_s * std::sqrt(1.0 - damping_ratio * damping_ratio);
  const double envelope = std::exp(-decay_rad_s * period_s);
  const double c = envelope * std::cos(damped_rad_s * period_s);
  const double s = envelope * std::sin(damped_rad_s * period_s) / damped_rad_s;
  xx_ = c + decay_rad_s * s;
  xv_ = s;
  vx_ = -w2_ * s;
  vv_ = c - decay_rad_s * s;
}

}  // namespace stillhand::signal
