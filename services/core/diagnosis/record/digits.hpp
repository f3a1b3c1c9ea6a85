// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string>

namespace stillhand::diagnosis {

/// A number with at most `count` significant digits, for sentences: digits(0.12345, 3) is "0.123".
/// @param count  1 to 17
inline std::string digits(double value, int count) { return fmt::format("{:.{}g}", value, count); }

}  // namespace stillhand::diagnosis
