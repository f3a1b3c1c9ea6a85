// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <span>

namespace stillhand::signal {

/// Arithmetic mean; NaN without values.
inline double mean(std::span<const double> values) noexcept {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Mean square about a level; NaN without values.
inline double mean_square(std::span<const double> values, double level = 0.0) noexcept {
  double sum = 0.0;
  for (const double value : values) sum += (value - level) * (value - level);
  return sum / static_cast<double>(values.size());
}

/// Root of the mean square about 0; NaN without values.
inline double rms(std::span<const double> values) noexcept {
  return std::sqrt(mean_square(values));
}

/// Mean square about the mean, over N and not N - 1; NaN without values.
inline double variance(std::span<const double> values) noexcept {
  return mean_square(values, mean(values));
}

}  // namespace stillhand::signal
