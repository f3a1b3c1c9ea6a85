// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <string>

/// Cells of the study's CSV files.
namespace stillhand::study::csv {

/// Shortest text that reads back as the same number; empty for a value that is not finite.
inline std::string text(double value) {
  if (!std::isfinite(value)) return "";
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

inline std::string row(std::initializer_list<std::string> cells) {
  std::string out;
  bool first = true;
  for (const std::string& cell : cells) {
    out += (first ? "" : ",") + cell;
    first = false;
  }
  return out + "\n";
}

}  // namespace stillhand::study::csv
