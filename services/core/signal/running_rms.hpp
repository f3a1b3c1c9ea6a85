// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "services/core/contract/tick.hpp"

namespace stillhand::signal {

/// RMS with a fading memory, Eq. SG-17: m' = (x^2 - m) / T, value sqrt(m), 0 at the start.  Unit of
/// x.  Pure; never allocates or throws.
class RunningRms {
 public:
  /// @param memory_s  T [s], positive
  explicit RunningRms(double memory_s) noexcept : forget_(kControlPeriod_s / memory_s) {}

  void step(double x) noexcept { mean_square_ += forget_ * (x * x - mean_square_); }
  [[nodiscard]] double value() const noexcept { return std::sqrt(mean_square_); }
  void reset() noexcept { mean_square_ = 0.0; }

 private:
  double forget_;
  double mean_square_ = 0.0;
};

}  // namespace stillhand::signal
