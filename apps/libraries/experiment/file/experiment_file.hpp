// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "apps/libraries/experiment/core/design.hpp"

namespace stillhand::experiment {

inline constexpr const char* kDesignFile = "experiment.yaml";

/// experiment.yaml with a comment above every key; read_design() gives the same design again.
std::string yaml_of(const Design& design);

/// The design in a text.
/// @throws ConfigError with file, line and column for an unknown key or a wrong value; check()
Design design_of(const std::string& yaml, const std::string& origin);

}  // namespace stillhand::experiment
