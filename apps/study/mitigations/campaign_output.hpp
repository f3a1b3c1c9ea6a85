// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/libraries/report/page.hpp"
#include "apps/libraries/report/plot/figure.hpp"
#include "apps/libraries/report/staged_folder.hpp"
#include "apps/study/mitigations/campaign.hpp"

namespace stillhand::study {

/// mitigations.csv: one row a cell; README, "Every mitigation".
std::string mitigations_csv(const Campaign& campaign);
/// mitigation_people.csv: one row a cell and person.
std::string mitigation_people_csv(const Campaign& campaign);
/// One figure a task: restored share of every mitigation, a panel a motion.
std::vector<report::Figure> campaign_figures(const Campaign& campaign);
/// Every mitigation in one task and motion.
report::Table table_of(const Campaign& campaign, TrialTask task, TrialMotion motion);
report::Page campaign_page(const Campaign& campaign, const std::string& command_line,
                           const std::vector<report::Drawing>& drawings);

/// Writes CSV files, figures and report.html into the folder, and publishes it.
void write_campaign(const Campaign& campaign, const std::string& command_line,
                    report::StagedFolder& folder);
/// The table of the task track, or of the last one that was run.
void print_campaign(const Campaign& campaign);

}  // namespace stillhand::study
