// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "services/core/signal/biquad.hpp"

namespace stillhand::signal {

/// Which side of the cutoff passes.
enum class Passband { kLow, kHigh };

/// Digital Butterworth filter as a cascade of second-order sections, Eq. SG-4: analogue prototype
/// poles s_k = exp(j pi (2k + n + 1) / (2n)), frequency prewarped (w = tan(pi fc / rate)), bilinear
/// transform; gain is exactly 1/sqrt(2) at the cutoff and 1 in the middle of the pass band.
/// Source: paper III-A (order 5, 10 Hz); Oppenheim and Schafer, section 7.2.
/// Pure; step() does not allocate.
class Butterworth {
 public:
  static constexpr int kMaxOrder = 8;

  /// @param order      1 to kMaxOrder
  /// @param cutoff_hz  -3 dB frequency [Hz], 0 < cutoff_hz < rate_hz / 2
  /// @param rate_hz    sample rate [Hz]
  /// @throws stillhand::ConfigError when a bound is broken.
  Butterworth(int order, double cutoff_hz, double rate_hz, Passband pass = Passband::kLow);

  double step(double x) noexcept {
    for (std::size_t i = 0; i < section_count_; ++i) x = sections_[i].step(x);
    return x;
  }
  void reset() noexcept;

 private:
  std::array<Biquad, kMaxOrder / 2> sections_{};
  std::size_t section_count_ = 0;
};

/// The whole record through a copy of the filter, starting from rest.  Same length and unit.
std::vector<double> filtered(Butterworth filter, const std::vector<double>& samples);

}  // namespace stillhand::signal
