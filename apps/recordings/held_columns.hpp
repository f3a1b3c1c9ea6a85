// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "apps/recordings/topic_table.hpp"

/// Columns of files that have no empty cells and restrict names: MATLAB's and HDF5's.
namespace stillhand::recordings {

/// Head of one column.
struct ColumnHead {
  std::string name;  ///< letters, digits and _; unique in its table
  std::string unit;  ///< empty: none stated
  recording::CellKind kind;
};

/// All columns of a table: the four of every message, then its own.
/// @param longest  most bytes of a name  @param taken  names that no column may have
std::vector<ColumnHead> column_heads(const TopicTable& table, std::size_t longest,
                                     std::set<std::string> taken = {});

/// Calls put(cell) for each column of column_heads(), in that order.
template <typename Put>
void for_each_cell(const TableRow& row, bool of_messages, Put put) {
  if (of_messages) {
    put(recording::Cell(static_cast<double>(row.since_start_ns) * 1e-9));
    put(recording::Cell(row.log_time_ns));
    put(recording::Cell(row.publish_time_ns));
    put(recording::Cell(std::uint64_t{row.sequence}));
  }
  for (const recording::Cell& cell : row.cells) put(cell);
}

/// Values of one column, held until the file takes them.  Only the list of its kind is filled.
struct HeldColumn {
  recording::CellKind kind;
  std::vector<std::int64_t> integers = {};
  std::vector<std::uint64_t> unsigneds = {};
  std::vector<double> reals = {};
  std::vector<std::string> texts = {};

  void take(const recording::Cell& cell);
  void clear();
};

}  // namespace stillhand::recordings
