// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "apps/libraries/measurement/tables/mapping.hpp"
#include "apps/libraries/measurement/tables/table_file.hpp"
#include "services/core/recording/recording.hpp"

namespace stillhand::measurement {

/// A file's columns as a recording, and a sentence for each change.
struct MappedRows {
  recording::Recording rows;
  std::vector<std::string> notes;
  std::vector<BackStep> back_steps = {};
  std::string loss = {};  ///< as TableHead's
};

/// Takes the columns that the mapping names, converts their units and leaves out rows that lack a
/// value: RECORDINGS_OF_OTHER_PROGRAMS.md.  Without a mapping of columns, the titles must be
/// 'name [unit]' and one of them the time, t or time.
/// @throws stillhand::ConfigError for a column that is not there, units that do not convert, times
///         that do not increase, and for titles that need a mapping: the message holds one that
///         would do.
MappedRows apply_mapping(TableFile& file, const Mapping& mapping);

/// The mapping that the titles themselves state; empty `columns` where they do not.
/// @param asked  its sample rate counts as a time
Mapping mapping_of_titles(const TableHead& head, const Mapping& asked);

}  // namespace stillhand::measurement
