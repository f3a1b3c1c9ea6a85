// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "apps/libraries/report/page.hpp"
#include "apps/libraries/report/plot/figure.hpp"
#include "apps/study/report/output.hpp"

/// A page for each participant of a recorded study.
namespace stillhand::study {

/// Names of the files of participants' pages begin and end so.
inline constexpr const char* kParticipantPage = "participant_";
inline constexpr const char* kPageEnding = ".html";
/// The page says so under its title; other files of such a name are not ours.
inline constexpr const char* kPageLead =
    "What one participant of the study did, next to the group and the paper.";

/// File of the page of each participant who has a complete tracking trial, by code.  Letters,
/// digits, '-' and '_' of the code stay; every file has another name.
std::map<std::string, std::string> participant_files(const RecordedSource& source);

/// How far a registered experiment is, and when and why it was unblinded; empty without one.
std::string state_of(const StudyRecord& record);

/// What the tables say of a participant: in them, or why not; one line each.
std::vector<std::string> remarks_on(const RecordedSource& source, const std::string& code);

/// Results of a participant: with the exclusion rules, otherwise without them; nullptr for who is
/// in neither.
const SubjectResult* result_of(const StudyRecord& record, const std::string& code);

/// Figures of one participant's page.
/// @param name  with which their names begin
std::vector<report::Figure> participant_figures(const StudyRecord& record, const std::string& code,
                                                const std::string& name);

/// The page; `drawings` of participant_figures().
report::Page participant_page(const StudyRecord& record, const std::string& code,
                              const std::vector<report::Drawing>& drawings);

/// On the report's page: each participant, with a link to the own page.
void add_participants(report::Page& page, const StudyRecord& record);

}  // namespace stillhand::study
