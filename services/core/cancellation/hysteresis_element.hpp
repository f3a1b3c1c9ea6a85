// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "services/core/cancellation/control_model.hpp"

namespace stillhand::cancellation {

/// A Hysteresis of the control model as it runs, METHOD Eq. CC-19:
///
///   w(clip(x, low, high) / threshold)
///
/// w is services/core/signal Eq. SG-19 or SG-20, the same function that the diagnosis fits with.
/// |w| is at most 1.  It trusts its numbers: check_model() comes first.  step() allocates nothing.
class HysteresisElement {
 public:
  /// Without memory: passes its argument on.
  HysteresisElement() = default;
  explicit HysteresisElement(const Hysteresis& of) noexcept
      : operator_(signal::step_of(of.operation)),
        threshold_(of.threshold),
        low_(of.low),
        high_(of.high) {}

  double step(double x) noexcept {
    if (operator_ == nullptr) return x;
    return operator_(std::clamp(x, low_, high_) / threshold_, memory_);
  }
  void reset() noexcept { memory_ = {}; }

 private:
  signal::HysteresisStep operator_ = nullptr;
  double threshold_ = 1.0;
  double low_ = 0.0;
  double high_ = 0.0;
  signal::HysteresisMemory memory_;
};

}  // namespace stillhand::cancellation
