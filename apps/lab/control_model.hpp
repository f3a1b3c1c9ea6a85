// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "services/core/cancellation/control_model.hpp"

namespace stillhand::lab {

/// Reads the control model of --model and checks it as the canceller does.
/// @param config  folder of the services' settings
/// @throws ConfigError when it is no control model, is of another rig, or the canceller would
///         refuse it
cancellation::ControlModel control_model(const std::filesystem::path& file, std::uint32_t rig,
                                         const std::filesystem::path& config);

}  // namespace stillhand::lab
