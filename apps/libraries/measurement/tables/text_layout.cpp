// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/text_layout.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "apps/libraries/measurement/tables/text_cells.hpp"
#include "apps/libraries/measurement/tables/titles.hpp"
#include "apps/libraries/measurement/tables/units.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::measurement {
namespace {

constexpr std::size_t kLinesLookedAt = 1000;
constexpr std::size_t kMostColumns = 10'000;

// In order of preference between equals.
constexpr std::array<TextForm, 7> kForms{
    {{'\t', '.'}, {'\t', ','}, {';', '.'}, {';', ','}, {',', '.'}, {' ', '.'}, {' ', ','}}};

// Cells of a line with one choice of signs.
struct LineShape {
  std::size_t cells = 0;
  std::size_t numbers = 0;
  std::size_t texts = 0;
  auto operator<=>(const LineShape&) const = default;
};

LineShape shape_of(std::string_view line, const TextForm& form,
                   std::vector<std::string_view>& cells) {
  split(line, form.separator, cells);
  LineShape shape{cells.size()};
  double number = 0.0;
  for (const std::string_view cell : cells) {
    switch (read_cell(cell, form.decimal, number)) {
      case CellContent::kNumber:
        ++shape.numbers;
        break;
      case CellContent::kText:
        ++shape.texts;
        break;
      case CellContent::kMissing:
        break;
    }
  }
  return shape;
}

// What one choice of signs makes of the lines.
struct Reading {
  TextForm form;
  std::vector<LineShape> lines;
  LineShape usual;           ///< the most frequent shape of a row
  std::ptrdiff_t score = 0;  ///< numbers less texts, over the rows with that many cells
};

Reading read_as(const TextForm& form, const std::vector<TextLine>& lines,
                const std::vector<TextLine>& later) {
  Reading out{form, {}, {}, 0};
  std::vector<std::string_view> cells;
  std::map<LineShape, std::ptrdiff_t> counts;
  std::map<std::size_t, std::ptrdiff_t> scores;  // by the number of cells
  const auto add = [&](const LineShape& shape) {
    if (shape.numbers == 0) return;
    ++counts[shape];
    scores[shape.cells] +=
        static_cast<std::ptrdiff_t>(shape.numbers) - static_cast<std::ptrdiff_t>(shape.texts);
  };
  for (const TextLine& line : lines) {
    out.lines.push_back(shape_of(line.text, form, cells));
    add(out.lines.back());
  }
  for (const TextLine& line : later) add(shape_of(line.text, form, cells));
  for (const auto& [width, score] : scores) {
    if (score <= out.score) continue;
    out.score = score;
    out.usual = {};
    std::ptrdiff_t most = 0;
    for (const auto& [shape, count] : counts) {
      if (shape.cells != width || count < most) continue;
      most = count;
      out.usual = shape;
    }
  }
  return out;
}

// A row may lack some of its values, and be shorter; a whole one may end with a comment.
bool is_row(const LineShape& line, const LineShape& usual) {
  const bool commented = line.cells <= usual.cells + 1 && line.numbers == usual.numbers;
  return (commented || (line.cells <= usual.cells && line.texts <= usual.texts)) &&
         line.numbers >= std::max<std::size_t>(1, usual.numbers / 2);
}

bool is_blank_line(const TextLine& line) {
  return line.text.find_first_not_of(" \t") == std::string_view::npos;
}

std::vector<TextLine> first_lines(std::string_view text) {
  std::vector<TextLine> lines;
  TextLines walk(text);
  TextLine line;
  while (lines.size() < kLinesLookedAt && walk.next(line)) {
    if (!is_blank_line(line)) lines.push_back(line);
  }
  return lines;
}

std::string_view without_comment_mark(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t#%/");
  return first == std::string_view::npos ? std::string_view() : line.substr(first);
}

bool says_degrees(std::string_view line) {
  std::string plain;
  for (const char c : without_comment_mark(line)) {
    if (c != ' ' && c != '\t') plain += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return plain == "indegrees=yes";
}

// As many lines again, spread over the rest: the first may hold whole numbers alone, which do not
// show the decimal sign.
std::vector<TextLine> later_lines(std::string_view text, std::size_t from) {
  std::vector<TextLine> lines;
  const std::size_t step = (text.size() - std::min(from, text.size())) / kLinesLookedAt + 1;
  for (std::size_t at = from; at < text.size(); at += step) {
    at = text.find('\n', at);
    TextLine line;
    if (at == std::string_view::npos || !TextLines(text, at + 1).next(line) || !line.ended) break;
    if (!is_blank_line(line) && !is_comment(line.text)) lines.push_back(line);
    at = line.offset;
  }
  return lines;
}

// A number alone above a table of several columns is a rate or a count, no row; and so is one that
// titles follow.
std::size_t first_row(const Reading& reading) {
  const std::size_t least_cells = std::min<std::size_t>(2, reading.usual.cells);
  const auto good = [&](std::size_t i) {
    return reading.lines[i].cells >= least_cells && is_row(reading.lines[i], reading.usual);
  };
  for (std::size_t i = 0; i + 1 < reading.lines.size(); ++i) {
    if (good(i) && good(i + 1)) return i;
  }
  const auto row = std::ranges::find_if(
      reading.lines, [&](const LineShape& line) { return is_row(line, reading.usual); });
  return static_cast<std::size_t>(row - reading.lines.begin());
}

// The first line of a spreadsheet that states its separator: "sep=;".
std::optional<char> stated_separator(const std::vector<TextLine>& lines) {
  if (lines.empty() || lines[0].text.size() != 5 || !lines[0].text.starts_with("sep=")) {
    return std::nullopt;
  }
  return lines[0].text[4];
}

std::vector<std::string> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  split(line, separator, cells);
  std::vector<std::string> out;
  for (const std::string_view cell : cells) out.emplace_back(plain_cell(cell));
  return out;
}

// "[s]" or "(s)" or "s"
std::string bare_unit(const std::string& cell) {
  const bool in_brackets = cell.size() > 2 && ((cell.front() == '[' && cell.back() == ']') ||
                                               (cell.front() == '(' && cell.back() == ')'));
  return in_brackets ? cell.substr(1, cell.size() - 2) : cell;
}

bool are_units(const std::vector<std::string>& cells) {
  return std::ranges::all_of(cells, [](const std::string& cell) {
    const std::string unit = bare_unit(cell);
    return unit.empty() || unit == "-" || unit == "1" || unit == "%" || is_unit(unit);
  });
}

struct RowWidth {
  std::size_t cells = 0;
  bool end_with_separator = false;  // the last cell of each is empty
};

RowWidth width_of(const std::vector<TextLine>& lines, const Reading& reading) {
  RowWidth out{reading.usual.cells, reading.form.separator != ' ' && reading.usual.cells > 1};
  std::vector<std::string_view> cells;
  for (std::size_t i = 0; i < lines.size() && out.end_with_separator; ++i) {
    if (!is_row(reading.lines[i], reading.usual) || reading.lines[i].cells < out.cells) continue;
    split(lines[i].text, reading.form.separator, cells);
    out.end_with_separator = plain_cell(cells.back()).empty();
  }
  return out;
}

constexpr std::string_view kComment = "Comment";

// Titles of one line.  Those at its end that no row has a cell for are left out: a separator behind
// the last title, and LabVIEW's "Comment".  Rows that end with a separator have a cell too many.
std::vector<std::string> titles_in(std::string_view line, char separator, RowWidth rows) {
  std::vector<std::string> titles = cells_of(line, separator);
  while (titles.size() > rows.cells && (titles.back().empty() || titles.back() == kComment)) {
    titles.pop_back();
  }
  if (rows.end_with_separator && titles.size() + 1 == rows.cells) titles.emplace_back();
  return titles;
}

// Titles from the lines above the first row, nearest line first.
void take_titles(const std::vector<TextLine>& lines, std::size_t first_row, RowWidth rows,
                 const std::string& path, TextLayout& out) {
  const std::size_t cells = rows.cells;
  const char separator = out.form.separator;
  std::vector<std::vector<std::string>> above;
  std::size_t nearest_line = 0;
  std::string_view comment;
  for (std::size_t i = first_row; i-- > 0 && above.size() < 2;) {
    if (is_comment(lines[i].text)) {
      if (comment.empty()) comment = without_comment_mark(lines[i].text);
      continue;
    }
    std::vector<std::string> titles = titles_in(lines[i].text, separator, rows);
    if (titles.size() == cells) {
      if (above.empty()) {
        nearest_line = lines[i].number;
        if (plain_cell(lines[i].text).ends_with(kComment)) out.comment_cells = 1;
      }
      above.push_back(std::move(titles));
      continue;
    }
    if (above.empty() && titles.size() > 1) {
      throw ConfigError(path + ":" + std::to_string(lines[i].number) + ":1",
                        std::to_string(titles.size()) + " titles above rows of " +
                            std::to_string(cells) + " cells, with " + separator_name(separator) +
                            " between them",
                        "a title for each cell; is the decimal sign taken for a separator?");
    }
    break;
  }
  if (above.empty() && !comment.empty()) {
    std::vector<std::string> titles = titles_in(comment, separator, rows);
    if (titles.size() == cells) above.push_back(std::move(titles));
  }
  if (above.size() == 2 && are_units(above[0])) {
    for (std::string& cell : above[0]) out.units.push_back(bare_unit(cell));
    out.units_line = nearest_line;
    above.erase(above.begin());
  }
  if (!above.empty()) out.titles = std::move(above[0]);
  out.titles.resize(cells);
  if (rows.end_with_separator && out.titles.back().empty()) out.titles.pop_back();
  for (std::size_t i = 0; i < out.titles.size(); ++i) {
    if (out.titles[i].empty()) out.titles[i] = "column " + std::to_string(i + 1);
  }
}

// What a head of LabVIEW (NI, "Specification for the LabVIEW Measurement File") states about its
// columns: units, and the step of times that no column holds.
void take_labview(const std::vector<TextLine>& lines, std::size_t first_row, TextLayout& out) {
  if (out.titles.empty() || out.titles[0] != "X_Value") return;
  bool no_times = false;
  double step_s = 0.0;
  for (std::size_t i = 0; i < first_row; ++i) {
    std::vector<std::string> cells = cells_of(lines[i].text, out.form.separator);
    if (cells[0] == "Y_Unit_Label" && out.units.empty()) {
      cells[0] = "s";
      cells.resize(out.titles.size());
      out.units = std::move(cells);
      out.units_line = lines[i].number;
    } else if (cells.size() > 1 && cells[0] == "X_Columns") {
      no_times = cells[1] == "No";
    } else if (cells.size() > 1 && cells[0] == "Delta_X") {
      (void)read_cell(cells[1], out.form.decimal, step_s);
    }
  }
  if (no_times && step_s > 0.0) out.rate_hz = 1.0 / step_s;
}

/// Of a text in which no table was found.
[[noreturn]] void refuse(const std::vector<TextLine>& lines, const std::string& path) {
  if (!lines.empty() && lines.front().text.starts_with("panel,x_axis,")) {
    throw ConfigError(path, "the data of a figure",
                      "the recording that the figure shows: its page names it");
  }
  constexpr const char* kTable = "a table: a line of titles, then rows of numbers";
  throw ConfigError(path, lines.empty() ? "an empty file" : "no rows of numbers", kTable);
}

// A table that the signs of the command line or of the mapping's file hide.
void refuse_signs(std::string_view text, const TextForm& asked, const std::string& path) {
  if (asked.separator == 0 && asked.decimal == 0) return;
  TextForm shown;
  try {
    shown = find_layout(text, {}, path).form;
  } catch (const ConfigError&) {
    return;  // no other signs help
  }
  const auto words = [](const TextForm& form) {
    std::string out;
    if (form.separator != 0) out = separator_name(form.separator) + " between columns";
    if (form.decimal != 0) {
      out += std::string(out.empty() ? "" : " and ") + "'" + form.decimal + "' as decimal sign";
    }
    return out;
  };
  throw ConfigError(path, "no rows of numbers with " + words(asked),
                    words(shown) + ", as the file has: leave --separator and --decimal out");
}

}  // namespace

std::string separator_name(char separator) {
  if (separator == '\t') return "tabs";
  if (separator == ' ') return "blanks";
  return "'" + std::string(1, separator) + "'";
}

TextLayout find_layout(std::string_view text, const TextForm& asked, const std::string& path) {
  std::vector<TextLine> lines = first_lines(text);
  TextForm wanted = asked;
  if (const auto stated = stated_separator(lines)) {
    if (wanted.separator == 0) wanted.separator = *stated;
    lines.erase(lines.begin());
  }
  std::vector<TextLine> plain;
  std::ranges::copy_if(lines, std::back_inserter(plain),
                       [](const TextLine& line) { return !is_comment(line.text); });
  const std::vector<TextLine> later =
      lines.empty() ? lines : later_lines(text, lines.back().offset);
  Reading best;
  for (const TextForm& form : kForms) {
    if (wanted.separator != 0 && form.separator != wanted.separator) continue;
    if (wanted.decimal != 0 && form.decimal != wanted.decimal) continue;
    Reading reading = read_as(form, plain, later);
    // Of equals the one with more columns: ",1" may be a tenth, or a cell behind an empty one.
    // Blanks divide at tabs, too: they must explain clearly more than those do.
    const std::ptrdiff_t margin = form.separator == ' ' ? best.score / 10 : 0;
    if (reading.score > best.score + margin ||
        (reading.score == best.score && reading.usual.cells > best.usual.cells)) {
      best = std::move(reading);
    }
  }
  if (best.score <= 0) {
    refuse_signs(text, asked, path);
    refuse(lines, path);
  }
  if (best.usual.cells > kMostColumns) {
    throw ConfigError(path, std::to_string(best.usual.cells) + " columns",
                      "at most " + std::to_string(kMostColumns));
  }
  const TextLine& first = plain[first_row(best)];
  TextLayout out;
  out.form = best.form;
  out.first_offset = first.offset;
  out.first_line = first.number;
  const auto at = std::ranges::find(lines, first.number, &TextLine::number);
  out.in_degrees =
      std::any_of(lines.begin(), at, [](const TextLine& line) { return says_degrees(line.text); });
  const auto row = static_cast<std::size_t>(at - lines.begin());
  take_titles(lines, row, width_of(plain, best), path, out);
  take_labview(lines, row, out);
  return out;
}

}  // namespace stillhand::measurement
