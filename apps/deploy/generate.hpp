// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/deploy/generated_file.hpp"
#include "apps/deploy/profiles.hpp"

namespace stillhand::deploy {

/// All files of a host.  The same inventory and profiles give the same text.
std::vector<GeneratedFile> files_of(const Inventory& inventory, const Host& host,
                                    const LabProfiles& profiles);

/// Writes out/HOST/ for every host, all of them or none.  Removes generated files of an earlier run
/// that are no longer needed.
/// @return folders of earlier runs whose host is no longer in the inventory
/// @throws ConfigError when a folder can't be written, std::runtime_error when a file can't.
std::vector<std::filesystem::path> generate(const Inventory& inventory, const LabProfiles& profiles,
                                            const std::filesystem::path& out);

}  // namespace stillhand::deploy
