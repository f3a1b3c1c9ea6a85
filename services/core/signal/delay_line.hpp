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

  double step(double x) noexcept { return step(x, ring_.size() - 1); }
  /// The same with a delay that may change from call to call.
  /// @param delay_samples  at most d of the constructor; a longer one counts as d
  double step(double x, std::size_t delay_samples) noexcept {
    const std::size_t size = ring_.size();
    const std::size_t back = delay_samples < size ? delay_samples : size - 1;
    ring_[next_] = x;
    const double out = ring_[next_ >= back ? next_ - back : next_ + size - back];
    next_ = next_ + 1 == size ? 0 : next_ + 1;
    return out;
  }
  void reset() noexcept {
    for (double& slot : ring_) slot = 0.0;
  }

 private:
  std::vector<double> ring_;
  std::size_t next_ = 0;
};

}  // namespace stillhand::signal
