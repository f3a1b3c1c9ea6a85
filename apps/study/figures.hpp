// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "apps/report/plot/figure.hpp"
#include "apps/study/output.hpp"

namespace stillhand::study {

/// The paper's figures of this study, named after their numbers: Fig. 4 and 6 (figures_models.cpp),
/// Fig. 7 to 13 (figures_tracking.cpp), and what the paper has no figure of: mitigations and wrong
/// models.  A figure whose conditions were not run is left out.
std::vector<report::Figure> study_figures(const StudyRecord& record);

/// Names of all figures that study_figures() can make.
inline constexpr std::array<const char*, 10> kFigureNames{"fig04_feedthrough_estimate",
                                                          "fig06_feedthrough_models",
                                                          "fig07_traces",
                                                          "fig08_moving_rms",
                                                          "fig09_moving_dwell",
                                                          "fig10_rms_error",
                                                          "fig11_dwell_ratio",
                                                          "fig12_open_loop",
                                                          "fig13_crossover",
                                                          "wrong_models"};

/// Parts of study_figures().
report::Figure figure_estimate(const StudyRecord& record);                 ///< Fig. 4
report::Figure figure_models(const StudyRecord& record);                   ///< Fig. 6
report::Figure figure_traces(const StudyRecord& record);                   ///< Fig. 7
report::Figure figure_moving_rms(const StudyRecord& record);               ///< Fig. 8
report::Figure figure_moving_dwell(const StudyRecord& record);             ///< Fig. 9
report::Figure figure_box(const StudyRecord& record, std::size_t metric);  ///< Fig. 10, 11, 13
report::Figure figure_open_loop(const StudyRecord& record);                ///< Fig. 12
report::Figure figure_wrong_models(const StudyRecord& record);

/// The subject that the figures of one subject show: the median of B's RMS error, or of the first
/// condition there is.
std::size_t typical_subject(const StudyRecord& record);

report::Colour colour_of(char condition);
/// "A stationary"
std::string label_of(char condition);
/// Letters of the conditions that were run, of those asked for.
std::string conditions_run(const StudyRecord& record, const std::string& among);

}  // namespace stillhand::study
