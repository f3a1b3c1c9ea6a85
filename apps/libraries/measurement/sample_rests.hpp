// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "services/core/signal/moments.hpp"

namespace stillhand::measurement {

/// [s] A hand does not rest for two periods of its fastest, 10 Hz, without a sign of it.
inline constexpr double kShortestStuck_s = 0.2;
/// Two rows can be equal by chance at the top of a swing.
inline constexpr std::size_t kClippedRows = 3;

/// Median of size(row) of up to 20,000 rows, evenly spread: a median's standard error is then below
/// 1 %.
template <typename Size>
double middle_over_rows(std::size_t first, std::size_t end, const Size& size) {
  constexpr std::size_t kMostRows = 20'000;
  const std::size_t step = (end - first) / kMostRows + 1;
  std::vector<double> sizes;
  for (std::size_t i = first; i < end; i += step) sizes.push_back(size(i));
  return signal::middle_of(std::move(sizes));
}

}  // namespace stillhand::measurement
