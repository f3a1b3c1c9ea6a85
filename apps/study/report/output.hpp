// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/libraries/report/staged_folder.hpp"
#include "apps/study/recorded/diagnoses.hpp"
#include "apps/study/recorded/recorded_trial.hpp"
#include "apps/study/recorded/simulated_people.hpp"
#include "apps/study/subjects/analysis.hpp"

namespace stillhand::study {

/// Inputs and results of a study.
struct StudyRecord {
  StudyOptions options;
  std::string command_line;
  std::string sealed;  ///< text of undeclared_effect.json; empty: there is no effect
  std::vector<SubjectResult> results;
  std::optional<RecordedSource> recorded;      ///< none: the subjects are simulated
  std::optional<std::vector<double>> plan_dz;  ///< --plan: further effect sizes; none: no plan
  std::vector<Needed> needed;                  ///< of --plan
  bool diagnose = false;                       ///< --diagnose
  std::optional<Diagnoses> diagnoses;          ///< of --diagnose
  bool simulate = false;                       ///< --simulated
  std::optional<SimulatedSide> simulated;      ///< of --simulated
  Analysis analysis;
  double wall_s = 0.0;
};

/// Who the subjects are: all of them, some, or none are simulated.
enum class Subjects { kSimulated, kMixed, kPeople };
Subjects subjects_of(const StudyRecord& record);

/// Level of one test, and the planned comparisons: those of the registration, otherwise 0.05 and
/// A-B, B-C.
double alpha_of(const StudyRecord& record);
std::vector<std::pair<Condition, Condition>> planned_pairs(const StudyRecord& record);

/// summary.json; README, "summary.json".
std::string summary_json(const StudyRecord& record);

/// A CSV file: header and rows of numbers.
struct CsvFile {
  std::string name;
  std::string text;
};

/// Metrics, subjects, models, moving averages and open loop as CSV.
std::vector<CsvFile> csv_files(const StudyRecord& record);

/// Writes report, figures and numbers; all files appear together.
/// @throws std::runtime_error with the file that could not be written and the reason; ConfigError
///         without gnuplot
void write_study(const StudyRecord& record, report::StagedFolder& folder);

/// Prints the results next to the paper's, on standard output.
void print_study(const StudyRecord& record);

}  // namespace stillhand::study
