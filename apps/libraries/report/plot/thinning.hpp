// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace stillhand::report {

/// Lines of at most this many points are drawn as they are.
inline constexpr std::size_t kThinAbove = 2000;

/// Selects points of a line or band so that its picture stays the same.  Of all points in one
/// column of pixels it keeps the first, the last, the lowest of `low` and the highest of `high`, in
/// their order.
///
/// @param column_px  place on the picture [px]; if it ever decreases, every point is kept
/// @param low, high  lower and upper edge, both the same for a line; as long as column_px, finite
/// @param width_px   points left of 0, and points right of this, are out of sight: one column each
/// Pure.
std::vector<std::size_t> thin_line(std::span<const double> column_px, std::span<const double> low,
                                   std::span<const double> high, double width_px);

/// Selects points of a cloud: the first in each square pixel.  Pure.
/// @param column_px, row_px  place on the picture [px], finite
std::vector<std::size_t> thin_points(std::span<const double> column_px,
                                     std::span<const double> row_px);

}  // namespace stillhand::report
