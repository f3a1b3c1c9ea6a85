// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/libraries/measurement/tables/guarded_table.hpp"

namespace stillhand::measurement::made {

/// "title unit: values" of each column, values as integers, then what the reader notes.
inline std::vector<std::string> columns_in_words(const BinaryReader& reader,
                                                 const std::string& path) {
  const TableHead head = reader.head(path);
  std::vector<std::string> out;
  std::vector<std::string> notes = head.notes;
  for (std::size_t i = 0; i < head.columns.size(); ++i) {
    out.push_back(head.columns[i].title + " " + head.columns[i].unit + ":");
    const RawColumns read = reader.read(path, head, {i});
    for (const double each : read.values.at(0)) {
      out.back() += each == each ? " " + std::to_string(static_cast<int>(each)) : " -";
    }
    notes.insert(notes.end(), read.notes.begin(), read.notes.end());
  }
  out.insert(out.end(), notes.begin(), notes.end());
  return out;
}

}  // namespace stillhand::measurement::made
