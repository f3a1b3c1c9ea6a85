// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/libraries/report/page.hpp"
#include "apps/study/report/output.hpp"

namespace stillhand::study {

/// report.html: Tables I and II next to the paper's, the figures, the statistics, the open
/// questions.  @param drawings  the drawn study_figures()
report::Page study_report(const StudyRecord& record, const std::vector<report::Drawing>& drawings);

}  // namespace stillhand::study
