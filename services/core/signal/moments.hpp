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

/// Pearson's correlation of two series of one length; 0 where one of them is constant.
inline double correlation(std::span<const double> x, std::span<const double> y) noexcept {
  const double mean_x = mean(x);
  const double mean_y = mean(y);
  double xy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) xy += (x[i] - mean_x) * (y[i] - mean_y);
  const double scale = std::sqrt(mean_square(x, mean_x)) * std::sqrt(mean_square(y, mean_y));
  return scale > 0.0 ? xy / static_cast<double>(x.size()) / scale : 0.0;
}

/// The middle value by size, the upper one of two; 0 without values.
inline double middle_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace stillhand::signal
