// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "apps/libraries/measurement/tables/table_file.hpp"

namespace stillhand::measurement {

/// An XDF file of LabRecorder, version 1.0 of its authors' specification: each channel of a stream
/// of numbers is a column, "stream.channel".  Time stamps are put onto the recorder's clock by the
/// offsets that the file holds, Eq. ME-18.  RECORDINGS_OF_OTHER_PROGRAMS.md.
/// @param bytes  the file  @param path  for messages
std::unique_ptr<TableFile> xdf_table(const std::string& bytes, const std::string& path,
                                     std::size_t most_values);

}  // namespace stillhand::measurement
