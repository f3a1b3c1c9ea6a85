// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

namespace stillhand::statistics {

struct ShareInterval {
  double share = 0.0;  ///< [-]
  double low = 0.0;
  double high = 0.0;
};

/// Share of a count and its exact two-sided interval, README Eq. ST-19.  It is never shorter than
/// its confidence says.  Source: Clopper and Pearson, Biometrika 26(4), 1934.  Pure.
/// @throws stillhand::ConfigError when all is 0, count is larger, or the confidence is outside of
///         0 to 1
ShareInterval share_interval(std::size_t count, std::size_t all, double confidence = 0.95);

struct MedianInterval {
  double median = 0.0;
  // Without ends where the sample is too small for the confidence.
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

/// Median (ST-2) and its distribution-free interval between two order statistics, README Eq. ST-20.
/// Source: Hollander, Wolfe and Chicken, Nonparametric Statistical Methods, 3rd ed., 3.6.  Pure.
/// @throws stillhand::ConfigError as median(), or for a confidence outside of 0 to 1
MedianInterval median_interval(std::vector<double> values, double confidence = 0.95);

}  // namespace stillhand::statistics
