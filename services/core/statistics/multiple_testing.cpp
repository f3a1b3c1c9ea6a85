// SPDX-License-Identifier: Apache-2.0
#include "services/core/statistics/multiple_testing.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <string>

#include "services/core/contract/config_error.hpp"

namespace stillhand::statistics {
namespace {

// Indices of p from the smallest to the largest.
std::vector<std::size_t> ascending_order(const std::vector<double>& p) {
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!(p[i] >= 0.0 && p[i] <= 1.0)) {
      throw ConfigError("multiple_testing.p[" + std::to_string(i) + "]", std::to_string(p[i]),
                        "a value from 0 to 1");
    }
  }
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&p](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  return order;
}

}  // namespace

std::vector<double> holm_adjusted(const std::vector<double>& p) {
  const std::vector<std::size_t> order = ascending_order(p);
  std::vector<double> out(p.size());
  double largest = 0.0;
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    const double factor = static_cast<double>(p.size() - rank);
    largest = std::max(largest, std::min(1.0, factor * p[order[rank]]));
    out[order[rank]] = largest;
  }
  return out;
}

}  // namespace stillhand::statistics
