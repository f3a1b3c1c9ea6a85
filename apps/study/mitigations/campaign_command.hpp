// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "apps/study/report/output.hpp"

namespace stillhand::study {

/// What the command line says of a table of mitigations.
struct CampaignArguments {
  std::string mitigations;  ///< "all" or names; empty: no such table
  bool subjects_given = false;
  bool trial_given = false;
};

/// Runs the table with the options of a study, prints it and writes it to the folder.
/// @return exit status
int run_campaign_command(const StudyRecord& record, const CampaignArguments& words,
                         const std::filesystem::path& out);

}  // namespace stillhand::study
