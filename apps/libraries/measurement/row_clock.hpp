// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/libraries/measurement/row_count.hpp"
#include "services/core/recording/recording.hpp"

namespace stillhand::measurement {

/// Place of each row of a recording on a uniform grid.
struct RowPlaces {
  double rate_hz = 0.0;
  /// [periods] since the start of the row's stretch, strictly increasing.  Whole numbers unless
  /// `as_stamped`.
  std::vector<double> places;
  std::vector<RowStretch> stretches;
  bool as_stamped = false;      ///< the rows lie off the grid: interpolation is needed
  double jitter_periods = 0.0;  ///< [periods] median distance of a row from its grid sample
  double lost_between = 0.0;    ///< [rows] missing in the long gaps between the stretches
};

/// Finds the sample clock behind the time stamps, README Eqs. ME-1 to ME-3.  Stamps that were only
/// rounded when they were printed are put on the grid.  Stamps that differ from it by more than 2 %
/// of a period (median) are taken as true.  Pure.
/// @throws stillhand::ConfigError when the times give no usable rate.
RowPlaces place_rows(const recording::Recording& rows);

}  // namespace stillhand::measurement
