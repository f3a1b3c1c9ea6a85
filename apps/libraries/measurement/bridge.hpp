// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace stillhand::measurement {

/// Values of one stretch of rows on its grid, README Eq. ME-4: Lagrange's cubic through the two
/// rows next to the sample and one more on either side, a quarter of the rows' distance further
/// out. Near an end or a second gap the polynomial has fewer points.  A row that lies on a sample
/// is taken unchanged.
/// @param places   [periods] of each row, strictly increasing from 0
/// @param values   one a row
/// @param samples  [-] of the grid, from place 0
/// @param out      the samples are appended
void append_on_grid(std::span<const double> places, std::span<const double> values,
                    std::size_t samples, std::vector<double>& out);

/// Weights of the samples, README Eq. ME-3: 1 near rows, 0 inside a gap.  Inside a gap the rows are
/// more than 1.5 periods apart, and neither is within half a period.
void append_weights(std::span<const double> places, std::size_t samples, std::vector<double>& out);

}  // namespace stillhand::measurement
