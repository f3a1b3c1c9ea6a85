// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

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

/// The middle value by size, the upper one of two; 0 without values.
inline double middle_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace stillhand::signal
