// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>

namespace stillhand::experiment {

/// What a seed of an experiment is used for; each use has a stream of its own.
enum class SeedUse : std::uint32_t {
  kSquare = 101,
  kOrder = 102,
  kLabels = 103,
  kSession = 104,
  kIdentification = 105,
  kMotion = 106,
  kTarget = 107,
};

/// A 32-bit seed from another one, Eq. EX-4: the first word of std::seed_seq over the low and high
/// word of `seed`, the use, and two numbers.
inline std::uint64_t derived_seed(std::uint64_t seed, SeedUse use, std::uint64_t first = 0,
                                  std::uint64_t second = 0) {
  std::seed_seq mix{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                    static_cast<std::uint32_t>(use), static_cast<std::uint32_t>(first),
                    static_cast<std::uint32_t>(second)};
  std::uint32_t word = 0;
  mix.generate(&word, &word + 1);
  return word;
}

}  // namespace stillhand::experiment
