// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace stillhand::statistics {

/// Sums and squares of values up to this one stay far from overflow.
inline constexpr double kLargestMagnitude = 1e100;

/// What every function here asks of a sample: at least `least` values, all finite and at most 1e100
/// in magnitude, so that neither a sum nor a square of them overflows.  Pure.
/// @param name  what the message begins with, for example "t_test.first"
/// @throws stillhand::ConfigError naming the first value that breaks the rule.
void require_sample(const std::vector<double>& values, std::size_t least, const std::string& name);

/// @throws stillhand::ConfigError unless 0 < value < 1.
void require_inside_unit_interval(double value, const std::string& name);

}  // namespace stillhand::statistics
