// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "apps/study/report/output.hpp"

/// What `stillhand study` does, for each form of a study: run, write into `out`, print.  They
/// return the exit status.  @throws ConfigError, Interrupted and as write_study().
namespace stillhand::study {

int run_whole(StudyRecord& record, const std::filesystem::path& out);

/// The participants of recordings; `folders` as find_sessions().  Of `record`, only the command
/// line and the plan are used.
int run_recorded(StudyRecord& record, const std::vector<std::filesystem::path>& folders,
                 const std::filesystem::path& out);

}  // namespace stillhand::study
