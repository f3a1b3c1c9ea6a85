// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "apps/libraries/experiment/core/design.hpp"

namespace stillhand::experiment {

inline constexpr const char* kDesignFile = "experiment.yaml";

/// "stillhand experiment VERB FOLDER" as a person may type it in a shell, with what the verb
/// requires.
std::string command_for(std::string_view verb, const std::filesystem::path& folder);

/// experiment.yaml of a folder as it was registered; its SHA-256 names the experiment.  An editor
/// of Windows changes the ends of lines and writes a mark of the byte order: neither counts.
std::string registered_text(const std::filesystem::path& folder);

/// experiment.yaml with a comment above every key; read_design() gives the same design again.
std::string yaml_of(const Design& design);

/// The design in a text.
/// @throws ConfigError with file, line and column for an unknown key or a wrong value; check()
Design design_of(const std::string& yaml, const std::string& origin);

}  // namespace stillhand::experiment
