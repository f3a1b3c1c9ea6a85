// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace stillhand::measurement {

/// [s] A hand does not rest for two periods of its fastest, 10 Hz, without a sign of it.
inline constexpr double kShortestStuck_s = 0.2;
/// Two rows can be equal by chance at the top of a swing.
inline constexpr std::size_t kClippedRows = 3;

/// The upper one of two in the middle; 0 of none.
inline double middle_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Median of size(row) of up to 20,000 rows, evenly spread: a median's standard error is then below
/// 1 %.
template <typename Size>
double middle_over_rows(std::size_t first, std::size_t end, const Size& size) {
  constexpr std::size_t kMostRows = 20'000;
  const std::size_t step = (end - first) / kMostRows + 1;
  std::vector<double> sizes;
  for (std::size_t i = first; i < end; i += step) sizes.push_back(size(i));
  return middle_of(std::move(sizes));
}

}  // namespace stillhand::measurement
