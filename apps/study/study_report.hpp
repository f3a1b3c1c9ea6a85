// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/report/page.hpp"
#include "apps/study/output.hpp"

namespace stillhand::study {

/// report.html: tables I and II beside the paper's, its figures, the statistics, the open
/// questions.  @param drawings  of study_figures()
report::Page study_report(const StudyRecord& record, const std::vector<report::Drawing>& drawings);

}  // namespace stillhand::study
