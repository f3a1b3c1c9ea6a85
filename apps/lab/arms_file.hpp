// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "services/core/admittance/arm_model.hpp"

namespace stillhand::lab {

/// The fitted arm of a file that `stillhand identify --admittance --json` wrote.
/// @throws stillhand::ConfigError naming the file and the parameter that is missing or no number,
///         or an arm that is not stable.
admittance::ArmValues read_arm(const std::filesystem::path& file);

/// Relaxed, then holding: the values of PART_SCHEDULE.  @param files  of these two, in this order
/// @throws stillhand::ConfigError as read_arm(), or unless there are two.
std::vector<double> schedule_values(const std::vector<std::filesystem::path>& files);

}  // namespace stillhand::lab
