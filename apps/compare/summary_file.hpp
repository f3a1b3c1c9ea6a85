// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "apps/compare/core/comparison.hpp"

namespace stillhand::compare {

/// What summary.json of a folder says: of a study, a session or a closed loop.
/// @throws ConfigError for a folder without one, or for a file that is no such summary
Side read_summary(const std::filesystem::path& folder);

/// All folders; their names tell them apart.
/// @throws ConfigError also for a folder that is given twice
std::vector<Side> read_summaries(const std::vector<std::filesystem::path>& folders);

}  // namespace stillhand::compare
