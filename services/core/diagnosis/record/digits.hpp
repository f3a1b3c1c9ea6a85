// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace stillhand::diagnosis {

/// A number with at most `count` significant digits, for sentences: digits(0.12345, 3) is "0.123".
/// @param count  1 to 17
inline std::string digits(double value, int count) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*g", count, value);
  return text.data();
}

}  // namespace stillhand::diagnosis
