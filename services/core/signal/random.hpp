// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>

namespace stillhand::signal {

/// One independent stream a purpose.  The same (seed, stream) always gives the same sequence with
/// one standard library; streams of one seed do not overlap in practice.
inline std::mt19937_64 seeded_engine(std::uint64_t seed, std::uint64_t stream) {
  std::seed_seq mix{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                    static_cast<std::uint32_t>(stream), static_cast<std::uint32_t>(stream >> 32)};
  return std::mt19937_64(mix);
}

/// Seeded normal deviates.
class Gaussian {
 public:
  /// @param seed    the session's seed, a config field, stored in the recording
  /// @param stream  which use of it; a constant in the code that draws
  Gaussian(std::uint64_t seed, std::uint64_t stream) : engine_(seeded_engine(seed, stream)) {}

  /// Next deviate, mean 0, standard deviation 1.
  double operator()() noexcept { return normal_(engine_); }
  /// Next deviate, uniform in [0, 1).
  double uniform() noexcept { return std::generate_canonical<double, 53>(engine_); }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

}  // namespace stillhand::signal
