// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "services/core/contract/tick.hpp"
#include "services/core/signal/random.hpp"

namespace stillhand::human_operator {

/// The remnant: observation noise on the seen error, white with the two-sided density
///   Phi = pi rho (m + floor^2)  [m^2 s],   E{v(t) v(t + tau)} = Phi delta(tau)
/// where m is the running mean square of the error over `kMemory_s`.  Each draw is held for kHold
/// ticks and has the variance Phi / (kHold dt).  The noise is white to beyond 10 Hz, far above the
/// bandwidth of the muscle.  The same seed gives the same bits.
/// Source: README Eq. HO-4; Levison, Kleinman and Baron (1969).  Pure.
class Remnant {
 public:
  static constexpr double kMemory_s = 4.0;
  static constexpr int kHold = 20;

  /// @param ratio    rho [-], 0 switches the remnant off
  /// @param floor_m  RMS error below which the remnant stays constant [m]
  Remnant(double ratio, double floor_m, std::uint64_t seed, std::uint64_t stream)
      : per_mean_square_(std::numbers::pi * ratio / (kHold * kControlPeriod_s)),
        mean_square_m2_(0.0),
        floor_m2_(floor_m * floor_m),
        draw_(seed, stream) {}

  /// Noise to add to the error of this tick [m].
  /// @param growth  of rho, Eq. HO-7 [-]
  double step(double error_m, double growth = 1.0) noexcept {
    mean_square_m2_ += kForget * (error_m * error_m - mean_square_m2_);
    if (--left_ <= 0) {
      left_ = kHold;
      held_m_ = std::sqrt(growth * per_mean_square_ * (mean_square_m2_ + floor_m2_)) * draw_();
    }
    return held_m_;
  }

 private:
  static constexpr double kForget = kControlPeriod_s / kMemory_s;

  double per_mean_square_;
  double mean_square_m2_;
  double floor_m2_;
  signal::Gaussian draw_;
  double held_m_ = 0.0;
  int left_ = 0;
};

}  // namespace stillhand::human_operator
