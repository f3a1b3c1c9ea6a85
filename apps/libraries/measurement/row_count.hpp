// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace stillhand::measurement {

/// Rows [first_row, end_row) of a recording with no long gap between them.
struct RowStretch {
  std::size_t first_row = 0;
  std::size_t end_row = 0;
  double start_s = 0.0;          ///< [s] time of first_row, which is grid sample 0
  std::size_t grid_samples = 0;  ///< [-] up to the last sample between rows
};

/// Result of counting rows with a trial period, README Eq. ME-1: their places, and the quality of
/// the fit.
struct RowCount {
  std::vector<double> places;  ///< [periods] from the start of the row's stretch, whole numbers
  std::vector<RowStretch> stretches;  ///< cut at the long gaps, Eq. ME-3; without grid_samples
  double lost_between = 0.0;          ///< [rows] missing in those gaps
  bool crowded = false;               ///< two rows share a period
  bool lost = false;                  ///< the fit contradicts the count: the rows are on no grid
  double period_s = 0.0;              ///< [s] by least squares; the trial period if `lost`
  double median_periods = 0.0;        ///< [periods] distance of a row from its place, Eq. ME-2
  double range_periods = 0.0;  ///< [periods] earliest to latest row, the largest of all stretches

  /// True if the rounding of printed times explains every distance from a place, Eq. ME-2.
  [[nodiscard]] bool only_rounded(double resolution_s) const noexcept {
    return range_periods * period_s <= 1.1 * resolution_s;
  }
};

/// Most rows that are bridged [-], Eq. ME-3.
std::int64_t longest_bridge(double rate_hz) noexcept;

/// @param time_s  strictly increasing, at least two, of finite span
RowCount count_rows(const std::vector<double>& time_s, double period_s);

/// Least-squares period [s] if short gaps are no whole number of periods: a phase for each run of
/// rows between gaps.
double period_between_gaps(const std::vector<double>& time_s, const RowCount& count);

}  // namespace stillhand::measurement
