// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace stillhand::report {

/// A result replaces nothing that an experiment keeps, and stands in no place where the experiment
/// looks for a participant or session.
/// @param place   absolute, links followed
/// @param option  that names it, for the message
/// @throws ConfigError
void refuse_place_of_experiment(const std::filesystem::path& place, const std::string& option);

}  // namespace stillhand::report
