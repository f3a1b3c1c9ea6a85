// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/report/staged_folder.hpp"
#include "apps/study/analysis.hpp"

namespace stillhand::study {

/// What a study leaves behind.
struct StudyRecord {
  StudyOptions options;
  std::string command_line;
  std::string sealed;  ///< undeclared_effect.json; empty: there is no effect
  std::vector<SubjectResult> results;
  Analysis analysis;
  double wall_s = 0.0;
};

/// summary.json; README, "summary.json".
std::string summary_json(const StudyRecord& record);

/// A table as text: header and rows of numbers, for a spreadsheet.
struct CsvFile {
  std::string name;
  std::string text;
};

/// metrics, subjects, models, moving averages and open loop as CSV.
std::vector<CsvFile> csv_files(const StudyRecord& record);

/// Report, figures and numbers, all at once.
/// @throws std::runtime_error which file could not be written, and why; ConfigError without
/// gnuplot.
void write_study(const StudyRecord& record, report::StagedFolder& folder);

/// The table beside the paper's, on standard output.
void print_study(const StudyRecord& record);

}  // namespace stillhand::study
