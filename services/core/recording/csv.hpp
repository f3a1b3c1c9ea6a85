// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "services/core/recording/recording.hpp"

namespace stillhand::recording {

/// Reads a recording from CSV text.  The header has comma-separated titles `name [unit]`; `t [s]`
/// is first and strictly increasing.  Each row is a sample, every cell is a finite number, and
/// there are at least two rows.  A byte order mark, CRLF, blanks around cells and quoted titles are
/// accepted.  `gaps` lists missing rows.
/// @param source  name of the text, for messages
/// @throws ConfigError "<source>:<line>:<column>: got ..., want ..."; the column counts characters
///         from 1.
Recording parse_csv(std::string_view text, const std::string& source);

/// The unit that a column of this name has ("a_y": "m/s^2"), or empty: any.
std::string_view known_unit(std::string_view name);

/// The reverse.  Each number has the shortest form that gives the same double again.
std::string to_csv(const Recording& recording);

}  // namespace stillhand::recording
