// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "apps/libraries/session/on_time.hpp"

namespace stillhand::session {

/// What a session's processes read of sensing.yaml, cancellation.yaml and rig.yaml.
/// @param config  folder of the settings  @throws ConfigError when a file is wrong
AnswerConfigs load_answers(const std::filesystem::path& config);

}  // namespace stillhand::session
