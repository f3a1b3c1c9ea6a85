// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>

namespace stillhand::planted {

/// Random numbers of one purpose: the same (seed, stream) always gives the same sequence.
class Draw {
 public:
  Draw(std::uint64_t seed, std::uint64_t stream) {
    std::seed_seq mix{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                      static_cast<std::uint32_t>(stream), static_cast<std::uint32_t>(stream >> 32)};
    engine_.seed(mix);
  }

  /// Uniform in [0, 1).
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * unit(); }
  /// Uniform in the logarithm; 0 < low <= high.
  double log_uniform(double low, double high) { return low * std::pow(high / low, unit()); }
  bool chance(double probability) { return unit() < probability; }
  double sign() { return chance(0.5) ? 1.0 : -1.0; }
  /// One of 0 .. count-1.
  std::size_t index(std::size_t count) {
    return static_cast<std::size_t>(unit() * static_cast<double>(count));
  }
  /// Mean 0, standard deviation 1 (Box and Muller).
  double normal() {
    if (spare_ready_) {
      spare_ready_ = false;
      return spare_;
    }
    const double radius = std::sqrt(-2.0 * std::log(1.0 - unit()));
    const double angle_rad = 2.0 * std::numbers::pi * unit();
    spare_ = radius * std::sin(angle_rad);
    spare_ready_ = true;
    return radius * std::cos(angle_rad);
  }

 private:
  std::mt19937_64 engine_;
  double spare_ = 0.0;
  bool spare_ready_ = false;
};

}  // namespace stillhand::planted
