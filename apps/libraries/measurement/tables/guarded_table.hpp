// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/libraries/measurement/tables/table_file.hpp"

namespace stillhand::measurement {

/// Reader of one kind of binary file.  Both functions run in a child (in_child.hpp): they may
/// crash, and throw Refused.
struct BinaryReader {
  std::function<TableHead(const std::string& path)> head;
  /// Values of these columns of the head, each of its `rows`.
  std::function<RawColumns(const std::string& path, const TableHead& head,
                           const std::vector<std::size_t>& columns)>
      read;
};

/// A file behind such a reader.  Columns that are read together must have equal rows.
/// @throws stillhand::ConfigError as the reader refuses, or because the file is damaged
std::unique_ptr<TableFile> guarded_table(const std::string& path, BinaryReader reader,
                                         std::size_t most_values);

/// Readers of MATLAB files (5, 7.3: libmatio), HDF5 files (libhdf5) and sound files (libsndfile).
BinaryReader mat_reader();
BinaryReader hdf5_reader();
BinaryReader sound_reader();

}  // namespace stillhand::measurement
