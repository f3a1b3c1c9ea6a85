// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace stillhand::measurement {

/// What a cell of a text table holds.
enum class CellContent { kNumber, kMissing, kText };

/// One line of a text, without its end.
struct TextLine {
  std::string_view text;
  std::size_t number = 0;  ///< from 1
  std::size_t offset = 0;  ///< [B] of its beginning
  bool ended = true;       ///< false: the text ends within it
};

/// Walks over the lines of a text, which must outlive it.
class TextLines {
 public:
  explicit TextLines(std::string_view text, std::size_t offset = 0, std::size_t number = 1)
      : text_(text), offset_(offset), number_(number) {}
  /// @returns false behind the last line
  bool next(TextLine& line);

 private:
  std::string_view text_;
  std::size_t offset_;
  std::size_t number_;
};

/// Cuts a line into cells.  A separator between double quotes is part of the cell.  ' ' stands for
/// any number of blanks and tabs.
void split(std::string_view line, char separator, std::vector<std::string_view>& cells);

/// Reads a number, also with Fortran's exponent ("1.5D+03"), or a stamp of ISO 8601 as [s]: since
/// 1970 with a date, since midnight without.  Blanks and quotes around it are left out.  Empty
/// cells and the usual words for nothing (NaN, NA, null, -, ...) are missing.
CellContent read_cell(std::string_view cell, char decimal, double& number);

/// "#", "%" or "//" in front.
bool is_comment(std::string_view line);

/// A cell for a message: in quotes, of limited length.
std::string in_quotes(std::string_view text);

}  // namespace stillhand::measurement
