// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::signal {

/// Second-order lag, exact for an input held over the tick, README Eq. SG-16:
///
///   x'' = w^2 (u - x) - 2 z w x',   lag at low frequency 2 z / w
///
/// A mass on spring and damper, or a subject's arm and muscle: the closed solution of the damped
/// oscillator over one tick.  Unit of u in, same unit out.  Pure.
class SecondOrderLag {
 public:
  struct State {
    double x, v, a;  ///< [unit, unit/s, unit/s^2]
  };

  /// @param natural_rad_s  w [rad/s], positive
  /// @param damping_ratio  z [-], 0 < z < 1
  /// @param period_s       length of a tick [s]
  SecondOrderLag(double natural_rad_s, double damping_ratio, double period_s);

  /// State at the tick at which the input becomes `u`; `u` acts on the ticks after it.
  State step(double u) noexcept {
    const State now{x_, v_, w2_ * (u - x_) - damping_ * v_};
    const double from_u = x_ - u;
    x_ = u + xx_ * from_u + xv_ * now.v;
    v_ = vx_ * from_u + vv_ * now.v;
    return now;
  }
  void reset() noexcept { x_ = v_ = 0.0; }

 private:
  double w2_, damping_;
  double xx_, xv_, vx_, vv_;
  double x_ = 0.0, v_ = 0.0;
};

}  // namespace stillhand::signal
