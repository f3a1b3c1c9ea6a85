// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "services/diagnosis/core/measurement.hpp"
#include "services/recording/core/recording.hpp"

namespace stillhand::measurement {

/// [samples] measured ones that a measurement has at least.
inline constexpr std::size_t kLeastSamples = 50;

/// Puts the rows of a recording on a uniform grid: short gaps filled in with weight 0, long ones
/// between stretches, stretches too short to tell anything left out, jittered rows resampled.  What
/// was done is in the notes.  Takes the rows' memory over where nothing has to be interpolated.
/// @param rows  as parse_csv() gives them; columns may not be empty
/// @param most_values  [-] samples times channels of the result at most
/// @throws stillhand::ConfigError when nothing useful is left, or too much.
diagnosis::Measurement on_grid(recording::Recording rows, std::size_t most_values);

}  // namespace stillhand::measurement
