// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/libraries/report/page.hpp"
#include "apps/study/report/output.hpp"

/// Parts of study_report().
namespace stillhand::study {

// report_tables.cpp
/// Tables I and II, restoration, outcome, calibration; conditions A, B and C were run.
void add_paper_tables(report::Page& page, const StudyRecord& record);
/// MANOVA, and the number of subjects needed.
void add_statistics(report::Page& page, const Analysis& analysis);

// report_registered.cpp
/// Exclusions and planned comparisons of an experiment; the number of participants of --plan.
void add_registered(report::Page& page, const StudyRecord& record);

// report_simulated.cpp
/// Simulated subjects next to the participants, and the paired comparison of the same people.
/// @param drawing  of figure_simulated(), or nullptr
void add_simulated(report::Page& page, const StudyRecord& record, const report::Drawing* drawing);
report::Figure figure_simulated(const StudyRecord& record);
/// Whether recorded and simulated people differ by more than chance.
std::string chance_sentence(const SimulatedSide& simulated);

// report_loop.cpp
/// Every number under every condition.
report::Table numbers_table(const Analysis& analysis);
/// Restoration of each metric, by each canceller.
report::Table restorations_table(const Analysis& analysis);
/// Open loop at the lines of the target, Eq. SU-3.
void add_open_loop(report::Page& page, const Analysis& analysis);
/// Conditions D, E and F against B.
void add_mitigations(report::Page& page, const StudyRecord& record);
/// C, C' and C+ next to each other, where a session ran C' or C+.
void add_cancellers(report::Page& page, const Analysis& analysis);
/// Surviving shares, Eq. SU-4.
void add_wrong_models(report::Page& page, const Analysis& analysis);

}  // namespace stillhand::study
