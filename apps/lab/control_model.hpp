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

/// [s] from the canceller's answer to a model until that model alone acts: its notice, its slowest
/// transient and the fade (cancellation, CC-4 and CC-15).  @throws ConfigError as control_model()
double settled_after_s(const cancellation::ControlModel& model,
                       const std::filesystem::path& config);

}  // namespace stillhand::lab
