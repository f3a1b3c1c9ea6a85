// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "services/core/diagnosis/record/measurement.hpp"
#include "services/core/recording/recording.hpp"

namespace stillhand::measurement {

/// Least number of measured samples of a measurement [-].
inline constexpr std::size_t kLeastSamples = 50;
/// Most samples times channels [-], unless a caller says otherwise: 8 B each, 480 MB.
inline constexpr std::size_t kMostValues = 60'000'000;

/// Puts the rows of a recording on a uniform grid, README Eqs. ME-1 to ME-4.  Short gaps are filled
/// in with weight 0, long gaps separate stretches, very short stretches are left out, and jittered
/// rows are resampled.  The notes report each change.  If nothing has to be interpolated, the rows'
/// memory is reused.
/// @param rows  as parse_csv() returns them, with at least one column
/// @param most_values  [-] samples times channels of the result at most
/// @throws stillhand::ConfigError when too few or too many values are left.
diagnosis::Measurement on_grid(recording::Recording rows, std::size_t most_values = kMostValues);

}  // namespace stillhand::measurement
