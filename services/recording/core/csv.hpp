// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "services/recording/core/recording.hpp"

namespace stillhand::recording {

/// Reads a recording from CSV text: header `name [unit]`, comma-separated, `t [s]` first and
/// strictly increasing, one row a sample, every cell a finite number, at least two rows.  A byte
/// order mark, CRLF, blanks around cells and quoted header cells are accepted; missing rows show in
/// `gaps`.
/// @param source  name of the text, for messages
/// @throws ConfigError "<source>:<line>:<column>: got ..., want ..."; the column counts characters
///         from 1.
Recording parse_csv(std::string_view text, const std::string& source);

/// The reverse.  Numbers in the shortest form that reads back to the same double.
std::string to_csv(const Recording& recording);

}  // namespace stillhand::recording
