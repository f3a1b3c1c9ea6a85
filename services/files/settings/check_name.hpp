// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace stillhand::settings {

/// Check of an option that names a file or folder: an error text, or an empty text.  It refuses an
/// empty name.  Without this check, an unset variable of a script (`--security ""`)
/// would have the same effect as an omitted option.
inline std::string check_name(const std::string& word) {
  return word.empty() ? "got an empty name, want a name" : "";
}

}  // namespace stillhand::settings
