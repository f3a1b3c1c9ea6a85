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

/// An IDL text cut up: comments and preprocessor lines are no tokens.  The text outlives it.
struct IdlTokens {
  std::vector<IdlToken> tokens;                      ///< the last one is empty
  std::map<std::size_t, std::string_view> comments;  ///< first comment that begins on a line
};

/// Pure; takes every text, also one that is no IDL.
IdlTokens cut_idl(std::string_view text);

/// Unit in a comment: what the first brackets hold, unless that is a number or longer than a unit
/// is; empty: none.
std::string unit_in(std::string_view comment);

}  // namespace stillhand::recording
