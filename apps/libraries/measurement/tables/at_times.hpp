// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace stillhand::measurement {

/// Values of a signal at other times, Eq. ME-6: Lagrange's cubic through the two rows around
/// a time and one more on each side, fewer at the ends.  A time that a row has gets that row's
/// value unchanged.  NaN outside of the signal, and between rows that are more than `longest_s`
/// apart.  Pure.
/// @param time_s  [s] of the rows, strictly increasing
/// @param values  one a row
/// @param wanted_s  [s] increasing
std::vector<double> at_times(const std::vector<double>& time_s, const std::vector<double>& values,
                             const std::vector<double>& wanted_s, double longest_s);

/// Four usual steps: rows that are further apart are a gap.  0 of fewer than two rows.  Pure.
double longest_bridge_s(const std::vector<double>& time_s);

}  // namespace stillhand::measurement
