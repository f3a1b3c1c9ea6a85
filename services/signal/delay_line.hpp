// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace stillhand::signal {

/// Whole-sample delay, Eq. SG-5: y[n] = x[n - d], zero before the first sample.
/// Allocates at construction only.
class DelayLine {
 public:
  /// @param delay_samples  d [samples], 0 passes straight through
  explicit DelayLine(std::size_t delay_samples) : ring_(delay_samples + 1, 0.0) {}

  double step(double x) noexcept {
    ring_[next_] = x;
    next_ = next_ + 1 == ring_.size() ? 0 : next_ + 1;
    return ring_[next_];
  }
  void reset() noexcept {
    for (double& slot : ring_) slot = 0.0;
  }

 private:
  std::vector<double> ring_;
  std::size_t next_ = 0;
};

}  // namespace stillhand::signal
