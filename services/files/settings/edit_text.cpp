// SPDX-License-Identifier: Apache-2.0
#include "services/files/settings/edit_text.hpp"

#include <algorithm>
#include <cstddef>

namespace stillhand::settings {
namespace {

bool is_line_of(std::string_view line, std::string_view key) {
  return line.starts_with(key) && line.substr(key.size()).starts_with(':');
}

}  // namespace

std::string with_setting(std::string text, std::string_view key, std::string_view value) {
  constexpr std::string_view kOff = "# ";
  const std::string setting = std::string(key) + ": " + std::string(value);
  if (!text.empty() && text.back() != '\n') text += '\n';
  std::size_t off = std::string::npos;  // begin of the line that is commented out
  for (std::size_t begin = 0; begin < text.size(); begin = text.find('\n', begin) + 1) {
    const std::string_view line =
        std::string_view(text).substr(begin, text.find('\n', begin) - begin);
    const bool commented = line.starts_with(kOff) && is_line_of(line.substr(kOff.size()), key);
    if (commented && off == std::string::npos) off = begin;
    if (!is_line_of(line, key)) continue;
    off = begin;
    break;
  }
  if (off == std::string::npos) return text + setting + '\n';
  const std::size_t end = text.find('\n', off);
  const std::size_t comment = text.find(" #", off + kOff.size());
  const bool keeps = comment < end;
  // The comment keeps its column where there is room.
  std::string line = setting;
  if (keeps) {
    const std::size_t column = comment + 1 - off;
    line.resize(std::max(line.size() + 2, column), ' ');
    line += text.substr(comment + 1, end - comment - 1);
  }
  return text.replace(off, end - off, line);
}

}  // namespace stillhand::settings
