// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/contract/tick.hpp"
#include "services/signal/butterworth.hpp"

namespace stillhand::human_operator {

/// How much of the error is too fast to be tracked, and what that does to the crossover, Eq. HO-5:
///
///   E' = (h^2 - E) / memory,   w_c = w_c0 / (1 + E / E_0^2)
///
/// h is the error above `above_hz` (second-order Butterworth).  Source: crossover regression,
/// README [McRuer and Jex 1967]; this form and E_0, README "Regression".  Pure.
class FastError {
 public:
  /// @param above_hz  cutoff [Hz]   @param memory_s  time constant of the mean [s]
  /// @throws stillhand::ConfigError when the cutoff is not below half the control rate.
  FastError(double above_hz, double memory_s)
      : high_pass_(2, above_hz, kControlRateHz, signal::Passband::kHigh),
        forget_(kControlPeriod_s / memory_s) {}

  void step(double error_m) noexcept {
    const double fast_m = high_pass_.step(error_m);
    mean_square_m2_ += forget_ * (fast_m * fast_m - mean_square_m2_);
  }
  /// E [m^2].
  [[nodiscard]] double mean_square_m2() const noexcept { return mean_square_m2_; }
  void reset() noexcept {
    high_pass_.reset();
    mean_square_m2_ = 0.0;
  }

 private:
  signal::Butterworth high_pass_;
  double forget_;
  double mean_square_m2_ = 0.0;
};

}  // namespace stillhand::human_operator
