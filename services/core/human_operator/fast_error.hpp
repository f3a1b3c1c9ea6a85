// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/contract/tick.hpp"
#include "services/core/signal/butterworth.hpp"

namespace stillhand::human_operator {

/// Mean square of the error that is too fast for tracking; it lowers the crossover frequency:
///   E' = (h^2 - E) / memory,   w_c = w_c0 / (1 + E / E_0^2)
/// h is the error above `above_hz` (second-order Butterworth).
/// Source: README Eq. HO-5 and "Regression"; McRuer and Jex (1967) for crossover regression, the
/// form and E_0 without a source.  Pure.
class FastError {
 public:
  /// @param above_hz  cutoff [Hz]   @param memory_s  time constant of the mean [s]
  /// @throws stillhand::ConfigError if the cutoff is not below half the control rate.
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
