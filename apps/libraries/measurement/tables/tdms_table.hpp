// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "apps/libraries/measurement/tables/table_file.hpp"

namespace stillhand::measurement {

/// A TDMS file of LabVIEW by its maker's document (NI, "TDMS File Format Internal Structure"): each
/// channel of numbers is a column, "group.channel", in the units that its linear scales give.  Its
/// times are those of its waveform properties (wf_start_time, wf_start_offset, wf_increment).
/// RECORDINGS_OF_OTHER_PROGRAMS.md.
/// @param bytes  the file  @param path  for messages
/// @throws stillhand::ConfigError for DAQmx raw data, and for scales that are not linear
std::unique_ptr<TableFile> tdms_table(const std::string& bytes, const std::string& path,
                                      std::size_t most_values);

}  // namespace stillhand::measurement
