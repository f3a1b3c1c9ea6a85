// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <set>
#include <string>
#include <string_view>

namespace stillhand::recordings {

/// A name that a file, an HDF5 object and a MATLAB variable may have: letters, digits and _, a
/// letter first, not longer than `most`, and none that is in `taken`, into which it goes.
inline std::string plain_name(std::string_view name, std::size_t most,
                              std::set<std::string>& taken) {
  std::string plain;
  for (const char c : name) {
    const bool word =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    plain += word ? c : '_';
  }
  const bool letter_first =
      !plain.empty() && ((plain[0] | 0x20) >= 'a' && (plain[0] | 0x20) <= 'z');
  if (!letter_first) plain.insert(0, "x");
  plain.resize(std::min(plain.size(), most));
  std::string unique = plain;
  for (int i = 2; !taken.insert(unique).second; ++i) {
    const std::string mark = "_" + std::to_string(i);
    unique = plain.substr(0, most - mark.size()) + mark;
  }
  return unique;
}

}  // namespace stillhand::recordings
