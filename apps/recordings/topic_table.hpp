// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "services/core/recording/messages/message_columns.hpp"

namespace stillhand::recordings {

/// One topic as a table: its head.
struct TopicTable {
  std::string name;  ///< of a file, a group or a variable: letters, digits and _; unique
  std::string topic;
  std::string type;
  std::vector<recording::MessageColumn> columns;  ///< of the message, behind the four of every row
  bool of_messages = true;  ///< false: rows have `cells` alone, and no time of a message
};

/// One message of it.
struct TableRow {
  std::int64_t since_start_ns;  ///< [ns] log time since the recording's start: column `t [s]`
  std::uint64_t log_time_ns;
  std::uint64_t publish_time_ns;
  std::uint32_t sequence;
  std::span<const recording::Cell> cells;  ///< one a column
};

/// For a column of numbers some of which are not there: those are NaN.
inline double real_of(const recording::Cell& cell) {
  if (const auto* value = std::get_if<double>(&cell)) return *value;
  if (const auto* value = std::get_if<std::int64_t>(&cell)) return static_cast<double>(*value);
  if (const auto* value = std::get_if<std::uint64_t>(&cell)) return static_cast<double>(*value);
  return std::nan("");
}

/// Kind of a column in files without empty cells: a list's end is NaN, which whole numbers lack.
inline recording::CellKind kind_without_gaps(const recording::MessageColumn& column) {
  const bool number = column.kind != recording::CellKind::kText;
  return column.in_list && number ? recording::CellKind::kReal : column.kind;
}

/// Where the rows of one topic go.
class TableSink {
 public:
  virtual ~TableSink() = default;
  virtual void take(const TableRow& row) = 0;
  /// After the last row: the topic is in the file.
  virtual void finish() = 0;
};

/// One kind of file: a folder of CSV files, a .mat file, an HDF5 file.
/// @throws from every method std::runtime_error when the file can't be written.
class TableFile {
 public:
  virtual ~TableFile() = default;
  /// One call a topic, before any row.
  /// @param rows  as many as the recording says that it holds; 0: that is not known
  /// @throws std::runtime_error where the file cannot hold as many
  virtual std::unique_ptr<TableSink> add(const TopicTable& table, std::uint64_t rows) = 0;
  /// The sinks have finished: everything is in the file.
  virtual void close() = 0;
  /// To its place, after close() of every file that is to appear with it.
  virtual void publish() = 0;
};

}  // namespace stillhand::recordings
