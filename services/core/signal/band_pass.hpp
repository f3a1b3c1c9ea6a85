// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/signal/butterworth.hpp"

namespace stillhand::signal {

/// High-pass, then low-pass (Butterworth, Eq. SG-4), of one order.
/// Pure; step() does not allocate.
class BandPass {
 public:
  /// @throws stillhand::ConfigError as Butterworth
  BandPass(int order, double low_hz, double high_hz, double rate_hz)
      : high_(order, low_hz, rate_hz, Passband::kHigh), low_(order, high_hz, rate_hz) {}

  double step(double x) noexcept { return low_.step(high_.step(x)); }
  void reset() noexcept {
    high_.reset();
    low_.reset();
  }

 private:
  Butterworth high_;
  Butterworth low_;
};

}  // namespace stillhand::signal
