// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/libraries/report/page.hpp"
#include "apps/libraries/report/plot/figure.hpp"
#include "apps/study/report/output.hpp"

/// The diagnoses of a recorded study (--diagnose) in its files.
namespace stillhand::study {

/// `diagnoses` of summary.json.
nlohmann::ordered_json diagnoses_json(const Diagnoses& diagnoses);

/// diagnoses.csv, a row a participant, and findings.csv, a row an effect.
std::vector<CsvFile> diagnoses_csv(const Diagnoses& diagnoses);

/// Force left by C and by C+, a line a participant.
report::Figure figure_gain(const Diagnoses& diagnoses);

/// On the report's page: effects over people, what C+ would have gained, who has no diagnosis.
/// @param drawing  of figure_gain(), or nullptr
void add_diagnoses(report::Page& page, const StudyRecord& record, const report::Drawing* drawing);

/// What C+ would have gained over the people.
std::string gain_sentence(const Diagnoses& diagnoses);

/// On a participant's page.
void add_diagnosis(report::Page& page, const StudyRecord& record, const std::string& code);

}  // namespace stillhand::study
