// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace stillhand::recording {

/// One word, number, text or sign of an IDL text.
struct IdlToken {
  std::string_view text;  ///< empty at the end of the text
  std::size_t line = 1;   ///< from 1
  std::size_t column = 1;
};

/// The tokens of an IDL text, without comments and preprocessor lines.  The text must outlive it.
struct IdlTokens {
  std::vector<IdlToken> tokens;                      ///< the last one is empty
  std::map<std::size_t, std::string_view> comments;  ///< first comment that begins on a line
};

/// Pure; accepts every text.
IdlTokens cut_idl(std::string_view text);

/// Unit in a comment: the content of the first brackets, unless it is a number or too long for a
/// unit; empty: none.
std::string unit_in(std::string_view comment);

}  // namespace stillhand::recording
