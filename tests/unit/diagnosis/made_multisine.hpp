// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::made {

/// Sines of random phase at multiples of 1/period, of equal size, RMS 1; repeats to the last bit.
inline std::vector<double> multisine(std::size_t count, std::size_t period,
                                     const std::vector<std::size_t>& harmonics,
                                     std::uint64_t seed) {
  const std::vector<double> phases = white(harmonics.size(), seed);
  std::vector<double> once(period, 0.0);
  for (std::size_t h = 0; h < harmonics.size(); ++h) {
    for (std::size_t n = 0; n < period; ++n) {
      const auto step = static_cast<double>(harmonics[h] * n % period);
      once[n] +=
          std::sin(2.0 * std::numbers::pi * step / static_cast<double>(period) + 7.0 * phases[h]);
    }
  }
  once = scaled_to(once, 1.0);
  std::vector<double> x(count);
  for (std::size_t n = 0; n < count; ++n) x[n] = once[n % period];
  return x;
}

}  // namespace stillhand::diagnosis::made
