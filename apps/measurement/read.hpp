// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "services/diagnosis/core/measurement.hpp"

namespace stillhand::measurement {

struct ReadOptions {
  /// Trial of a session's recording: its number, or the letter of its condition (I: identification)
  /// where only one trial has it.  Empty: the longest identification, without one the longest
  /// trial.
  std::string trial;
  /// [-] samples times channels that are read at most; 8 B each, and as much again while reading.
  std::size_t most_values = 60'000'000;
};

/// Reads a recording of either kind, told apart by its first bytes: an MCAP file of a session, or
/// CSV (design: "Recordings as CSV").  On a uniform grid afterwards; what was done to get there is
/// in the notes.  What a damaged or cut-off session's recording has lost is told on standard error,
/// in one line, and the rest is used.
/// @throws stillhand::ConfigError when the file can't be read or holds nothing useful: of CSV with
///         line and column, of a session with the trials there are.
diagnosis::Measurement read_measurement(const std::string& path, const ReadOptions& options = {});

/// Several recordings of one rig as stretches of one; time goes on where the one before ends.
/// @throws stillhand::ConfigError when there is none, rates differ by more than 0.1 %, or channels
/// by
///         name or unit.
diagnosis::Measurement join(std::vector<diagnosis::Measurement> parts);

}  // namespace stillhand::measurement
