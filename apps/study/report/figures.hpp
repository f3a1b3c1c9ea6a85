// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <complex>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "apps/libraries/report/plot/figure.hpp"
#include "apps/study/report/output.hpp"

namespace stillhand::study {

/// The figures of this study, named after the paper's: Fig. 4 and 6 (figures_models.cpp), Fig. 7 to
/// 9 and 12 (figures_tracking.cpp), Fig. 10, 11 and 13 (figures_boxes.cpp).  The figure of the
/// wrong models (figures_boxes.cpp) has no counterpart in the paper.  A figure whose conditions
/// were not run is left out.
std::vector<report::Figure> study_figures(const StudyRecord& record);

inline constexpr const char* kGainFigure = "diagnosis_gain";
inline constexpr const char* kSimulatedFigure = "simulated_next_to_recorded";

/// Names of all figures that study_figures() can make.
inline constexpr std::array<const char*, 12> kFigureNames{"fig04_feedthrough_estimate",
                                                          "fig06_feedthrough_models",
                                                          "fig07_traces",
                                                          "fig08_moving_rms",
                                                          "fig09_moving_dwell",
                                                          "fig10_rms_error",
                                                          "fig11_dwell_ratio",
                                                          "fig12_open_loop",
                                                          "fig13_crossover",
                                                          "wrong_models",
                                                          kGainFigure,
                                                          kSimulatedFigure};

/// Figures of one subject; the caption says whose.
report::Figure estimate_figure(const Identification& found, const std::string& name,
                               const std::string& caption);
/// A panel for each condition.
report::Figure traces_figure(const std::map<Condition, const TrackedTrial*>& trials,
                             const std::string& name, const std::string& caption);

/// Parts of study_figures().
report::Figure figure_estimate(const StudyRecord& record);                 ///< Fig. 4
report::Figure figure_models(const StudyRecord& record);                   ///< Fig. 6
report::Figure figure_traces(const StudyRecord& record);                   ///< Fig. 7
report::Figure figure_moving_rms(const StudyRecord& record);               ///< Fig. 8
report::Figure figure_moving_dwell(const StudyRecord& record);             ///< Fig. 9
report::Figure figure_box(const StudyRecord& record, std::size_t metric);  ///< Fig. 10, 11, 13
report::Figure figure_open_loop(const StudyRecord& record);                ///< Fig. 12
report::Figure figure_wrong_models(const StudyRecord& record);

/// The subject of the figures that show one subject: nearest to the median RMS error of B, or of
/// the first condition that was run.
std::size_t typical_subject(const StudyRecord& record);

/// Angle of a response [deg], above `highest_deg` - 360 and up to `highest_deg` (0 to 180): with an
/// end that no curve crosses, a curve needs no unwrapping.
double phase_up_to_deg(std::complex<double> response, double highest_deg);

report::Colour colour_of(Condition condition);
/// The conditions in `among` that were run.
std::vector<Condition> conditions_run(const StudyRecord& record, std::span<const Condition> among);
/// "subject 3", or a participant's code.
std::string subject_name(const StudyRecord& record, std::size_t index);

}  // namespace stillhand::study
