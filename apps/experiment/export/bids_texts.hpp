// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "apps/experiment/export/bids.hpp"

/// The texts of a data set that hold no samples.
namespace stillhand::experiment {

/// One channel of a motion file, in the words of the standard.
struct MotionChannel {
  const char* name;  ///< the column of the CSV format
  const char* component;
  const char* type;
  const char* tracked_point;
  const char* description;
};
/// The entry of a column.  @throws ConfigError for a column without one
const MotionChannel& channel_of(const std::string& column);

std::string dataset_description(const Design& design, const Release& release);
std::string readme(const Folder& folder, const DataSet& set, const Release& release);
std::string changes(const DataSet& set);
std::string participants_json();
/// Meaning and unit of the columns of a trial table.
std::string trials_json(TrialKind kind);
std::string answers_json(const Design& design);
std::string events_json();
/// Side file of one motion file.
std::string motion_json(const Design& design, const ExportedTrial& trial,
                        const recording::Recording& rows);
std::string channels_tsv(const recording::Recording& rows);
/// Meaning and unit of every column of the plain tables (export/tables.hpp), and their README.
std::string columns_json(const Design& design);
std::string tables_readme(const Folder& folder, const DataSet& set, const Release& release);

}  // namespace stillhand::experiment
