// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace stillhand::measurement {

struct DecodedText {
  std::string text;  ///< UTF-8, without a byte order mark; lines end in "\n" or "\r\n"
  std::string note;  ///< empty: it was UTF-8, and whole
};

/// UTF-8 is taken as it is.  A byte order mark, or a zero as each second byte, shows UTF-16.  Text
/// that is no UTF-8 is read as Windows-1252, which spreadsheets write for western languages.  Zeros
/// at the end are left out; no-break spaces become blanks and U+2212 a minus.
/// @throws stillhand::ConfigError for binary data and for text that is neither.
DecodedText to_utf8(std::string bytes, const std::string& path);

}  // namespace stillhand::measurement
