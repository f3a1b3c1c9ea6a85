// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "apps/libraries/measurement/grid.hpp"
#include "apps/libraries/measurement/sample_screen.hpp"
#include "apps/libraries/measurement/tables/mapping.hpp"
#include "apps/libraries/measurement/tables/table_file.hpp"
#include "services/core/diagnosis/record/measurement.hpp"

namespace stillhand::measurement {

struct ReadOptions {
  /// Trial of a session's recording: its number, or the letter of its condition (I: identification)
  /// if only one trial has it.  Empty: the longest identification trial, or the longest trial if
  /// there is none.
  std::string trial = {};
  /// Letter of a condition, as `trial`, for files that may also be tables; of several trials with
  /// it the last.  Empty: `trial` alone counts.
  std::string session_trial = {};
  /// The channels of lateness of a session too (apps/libraries/session/README.md).
  bool lateness = false;
  /// [-] samples times channels that are read at most; 8 B each, and as much again while reading.
  std::size_t most_values = kMostValues;
  ModelChannels channels = {};  ///< that the screening judges as the model's
  /// Columns, sample rate and signs of a file of another program,
  /// RECORDINGS_OF_OTHER_PROGRAMS.md.  If it is empty, the titles state the columns.
  Mapping mapping = {};
  std::string map_file = {};  ///< YAML file of a mapping; empty: none
  /// Makes the mapping for a `map_file` that is not there; empty: nobody can be asked.
  std::function<Mapping(TableFile&)> ask = {};
};

/// Reads a recording: an MCAP file of a session, CSV (services/processes/recording/README.md), or a
/// file of another program: a text table, MATLAB, HDF5, MCAP of ROS 2, WAV.  The first bytes show
/// which. The rows are screened, README "Screening"; what it found is in `screening` and in the
/// notes. The result is on a uniform grid; the notes say how it got there.  If a session's
/// recording is damaged or cut off, one line on standard error reports the loss, and the rest is
/// used.
/// @throws stillhand::ConfigError when the file can't be read or holds nothing useful.  The message
///         gives line and column of a text, the trials of a session, or a mapping that would do.
diagnosis::Measurement read_measurement(const std::string& path, const ReadOptions& options = {});

/// Joins recordings of one rig as stretches of one recording.  Time continues where the previous
/// recording ends.
/// @throws stillhand::ConfigError when `parts` is empty, rates differ by more than 0.1 %, or
///         channels differ in name or unit.
diagnosis::Measurement join(std::vector<diagnosis::Measurement> parts);

}  // namespace stillhand::measurement
