// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace stillhand::settings {

/// For CLI11: what is wrong with the name of a file or folder that an option was given, or nothing.
/// (An empty one, from a script's unset variable, would pass for an option that wasn't given:
/// `--security ""` for no security.)
inline std::string check_name(const std::string& word) {
  return word.empty() ? "got an empty name, want one" : "";
}

}  // namespace stillhand::settings
