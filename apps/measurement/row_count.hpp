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
  std::size_t grid_samples = 0;  ///< [-] to the last sample that rows enclose
};

/// A period tried out on rows: their places by counting, README Eq. ME-1, and how well it fits.
struct RowCount {
  std::vector<double> places;  ///< [periods] from the start of the row's stretch, whole numbers
  std::vector<RowStretch> stretches;  ///< cut at the long gaps, Eq. ME-3; without grid_samples
  double lost_between = 0.0;          ///< [rows] missing in those gaps
  bool crowded = false;               ///< two rows share a period
  bool lost = false;            ///< the fit left the count behind it: rows nowhere near a grid
  double period_s = 0.0;        ///< [s] by least squares, or as tried where that is lost
  double median_periods = 0.0;  ///< [periods] distance of a row from its place, Eq. ME-2
  double range_periods = 0.0;   ///< [periods] largest of a stretch, earliest to latest row

  /// No row is further from its place than printing its time can have put it.
  [[nodiscard]] bool only_rounded(double resolution_s) const noexcept {
    return range_periods * period_s <= 1.1 * resolution_s;
  }
};

/// [rows] that are bridged at most, Eq. ME-3.
std::int64_t longest_bridge(double rate_hz) noexcept;

/// @param time_s  strictly increasing, at least two, of finite span
RowCount count_rows(const std::vector<double>& time_s, double period_s);

/// [s] Least-squares period where short gaps aren't whole periods: a phase for each run of rows
/// between them.
double period_between_gaps(const std::vector<double>& time_s, const RowCount& count);

}  // namespace stillhand::measurement
