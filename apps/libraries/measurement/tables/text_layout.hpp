// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "apps/libraries/measurement/tables/table_file.hpp"

namespace stillhand::measurement {

/// Where the table lies in a text, and which signs it uses.
struct TextLayout {
  TextForm form;                    ///< no zeros
  std::vector<std::string> titles;  ///< one for each cell of a row
  std::vector<std::string> units;   ///< of a line of units below the titles; empty: none
  std::size_t units_line = 0;       ///< its number
  std::size_t comment_cells = 0;    ///< [-] that a row may have behind those of its titles
  double rate_hz = 0.0;             ///< [Hz] of LabVIEW's Delta_X, without a column of times; or 0
  bool in_degrees = false;          ///< a line above says "inDegrees=yes", as OpenSim does
  std::size_t first_offset = 0;     ///< [B] of the first row
  std::size_t first_line = 1;       ///< number of its line
};

/// Looks at the first thousand lines.  Of the signs that are possible, those are taken with which
/// most cells are numbers: each cell that is a number counts for them, each that is text against
/// them.  The titles are the line above the first row; comments (#, %, //) and lines of another
/// form above it are left out.  Without a line of titles they are "column 1", ...
/// @param asked  signs that are given; only the others are looked for
/// @throws stillhand::ConfigError if there is no row of numbers, or the titles are not as many as
///         the cells of a row.
TextLayout find_layout(std::string_view text, const TextForm& asked, const std::string& path);

/// "';'", "tabs", "blanks", for messages.
std::string separator_name(char separator);

}  // namespace stillhand::measurement
