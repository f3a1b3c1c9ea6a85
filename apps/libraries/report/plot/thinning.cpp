// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/thinning.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "services/core/contract/expects.hpp"

namespace stillhand::report {
namespace {

std::vector<std::size_t> all(std::size_t count) {
  std::vector<std::size_t> indices(count);
  std::iota(indices.begin(), indices.end(), std::size_t{0});
  return indices;
}

}  // namespace

std::vector<std::size_t> thin_line(std::span<const double> column_px, std::span<const double> low,
                                   std::span<const double> high, double width_px) {
  const std::size_t count = column_px.size();
  STILLHAND_EXPECTS(low.size() == count && high.size() == count);
  if (!std::is_sorted(column_px.begin(), column_px.end())) return all(count);
  const auto column = [&](std::size_t i) {
    return std::floor(std::clamp(column_px[i], -1.0, width_px));
  };
  std::vector<std::size_t> kept;
  for (std::size_t begin = 0; begin < count;) {
    std::size_t lowest = begin;
    std::size_t highest = begin;
    std::size_t end = begin;
    for (; end < count && column(end) == column(begin); ++end) {
      if (low[end] < low[lowest]) lowest = end;
      if (high[end] > high[highest]) highest = end;
    }
    std::array<std::size_t, 4> chosen{begin, lowest, highest, end - 1};
    std::sort(chosen.begin(), chosen.end());
    kept.insert(kept.end(), chosen.begin(), std::unique(chosen.begin(), chosen.end()));
    begin = end;
  }
  return kept;
}

std::vector<std::size_t> thin_points(std::span<const double> column_px,
                                     std::span<const double> row_px) {
  STILLHAND_EXPECTS(row_px.size() == column_px.size());
  std::set<std::pair<double, double>> taken;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < column_px.size(); ++i) {
    if (taken.emplace(std::floor(column_px[i]), std::floor(row_px[i])).second) {
      kept.push_back(i);
    }
  }
  return kept;
}

}  // namespace stillhand::report
