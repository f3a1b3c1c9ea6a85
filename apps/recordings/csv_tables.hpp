// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "apps/recordings/topic_table.hpp"

namespace stillhand::recordings {

/// One CSV file a topic in a folder, `t [s]` first; README, "CSV".
/// @throws ConfigError "--csv" when the folder can't be made or written.
std::unique_ptr<TableFile> csv_tables(const std::filesystem::path& folder);

}  // namespace stillhand::recordings
