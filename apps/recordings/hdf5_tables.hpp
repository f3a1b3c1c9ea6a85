// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "apps/recordings/topic_table.hpp"

namespace stillhand::recordings {

/// One HDF5 file: a group a topic, a data set a column with its unit as attribute; README, "HDF5".
/// Written block by block, so the memory does not grow with the recording.
/// @throws std::runtime_error when the file can't be made.
std::unique_ptr<TableFile> hdf5_tables(const std::string& path);

}  // namespace stillhand::recordings
