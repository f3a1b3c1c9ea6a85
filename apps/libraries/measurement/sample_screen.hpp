// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/core/diagnosis/record/measurement.hpp"
#include "services/core/recording/recording.hpp"

namespace stillhand::measurement {

/// Channels that the model of a verb has.
struct ModelChannels {
  std::vector<std::string> inputs{"a_y"};
  std::string output = "f";
};

/// Looks at the samples of every column, README "Screening" (ME-7 to ME-12), and takes out what is
/// no measurement: of a channel of the model its bad rows, another channel whole.  A fault that
/// would leave less than half of the rows takes nothing out; it makes the channel unsound.
/// Pure.  The rows' order in time is kept; rate and gaps are those of what is left.
/// @param rows  with their rate; at least 2
/// @throws stillhand::ConfigError when no column is left.
std::vector<diagnosis::SampleFault> screen(recording::Recording& rows,
                                           const ModelChannels& channels);

}  // namespace stillhand::measurement
