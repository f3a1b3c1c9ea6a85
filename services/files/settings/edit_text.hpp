// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace stillhand::settings {

/// The text of a settings file in which a key of the top level has this value.  The key's line is
/// changed, also one that is commented out with "# "; what stands behind the value on it stays, and
/// so do all other lines.  Without such a line, one is added at the end.
std::string with_setting(std::string text, std::string_view key, std::string_view value);

}  // namespace stillhand::settings
