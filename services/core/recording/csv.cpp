// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/csv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>

#include "services/core/contract/config_error.hpp"

namespace stillhand::recording {
namespace {

struct KnownColumn {
  std::string_view name;
  std::string_view unit;
};
// Names with a fixed unit: services/processes/recording/README.md, "CSV".
constexpr std::array<KnownColumn, 10> kKnownColumns{{{"t", "s"},
                                                     {"a_x", "m/s^2"},
                                                     {"a_y", "m/s^2"},
                                                     {"a_z", "m/s^2"},
                                                     {"roll", "rad"},
                                                     {"theta", "rad"},
                                                     {"omega", "rad/s"},
                                                     {"x_r", "m"},
                                                     {"x_p", "m"},
                                                     {"f", "N"}}};

// A message quotes at most this many characters of a cell.
constexpr std::size_t kQuotedCharacters = 40;

bool is_blank(char c) { return c == ' ' || c == '\t'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

// Control characters of a binary file would move the cursor of a terminal and split a message.
std::string quoted(std::string_view text) {
  std::string shown(text.substr(0, kQuotedCharacters));
  std::ranges::replace_if(shown, [](char c) { return (c >= 0 && c < ' ') || c == '\x7f'; }, '?');
  return "'" + shown + (text.size() <= kQuotedCharacters ? "'" : "...'");
}

std::string title(const Column& column) { return column.name + " [" + column.unit + "]"; }

// Walks over lines and cells and tracks its position.
class CsvText {
 public:
  CsvText(std::string_view text, const std::string& source) : rest_(text), source_(source) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
  }

  // Next line without its end; false when there is none.
  bool next_line(std::string_view& line) {
    if (rest_.empty()) return false;
    ++line_number_;
    const void* end = std::memchr(rest_.data(), '\n', rest_.size());
    const std::size_t length =
        end == nullptr ? rest_.size()
                       : static_cast<std::size_t>(static_cast<const char*>(end) - rest_.data());
    line = rest_.substr(0, length);
    rest_.remove_prefix(std::min(length + 1, rest_.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    line_ = line;
    return true;
  }

  // `at` lies in the current line.
  [[noreturn]] void fail(const char* at, const std::string& got, const std::string& want) const {
    const auto column = static_cast<std::size_t>(at - line_.data()) + 1;
    throw ConfigError(source_ + ":" + std::to_string(line_number_) + ":" + std::to_string(column),
                      got, want);
  }
  [[nodiscard]] std::string_view rest() const { return rest_; }
  [[nodiscard]] const std::string& source() const { return source_; }

 private:
  std::string_view rest_;
  std::string_view line_;
  const std::string& source_;
  std::size_t line_number_ = 0;
};

Column parse_title(const CsvText& text, std::string_view cell, std::size_t number) {
  const std::string_view raw = trimmed(cell);
  std::string_view inner = raw;
  if (inner.size() >= 2 && inner.front() == '"' && inner.back() == '"') {
    inner = trimmed(inner.substr(1, inner.size() - 2));
  }
  const std::size_t open = inner.find('[');
  const std::string example = number == 0 ? "'t [s]'" : "'name [unit]', for example 'f [N]'";
  if (inner.empty()) text.fail(raw.data(), "an empty column title", example);
  if (open == std::string_view::npos || !inner.ends_with(']') || inner.size() == open + 2) {
    text.fail(raw.data(), "the column title " + quoted(raw) + " without a unit",
              example + "; without dimension: '[-]'");
  }
  Column column;
  column.name = trimmed(inner.substr(0, open));
  column.unit = trimmed(inner.substr(open + 1, inner.size() - open - 2));
  if (column.name.empty()) text.fail(raw.data(), "a unit without a name: " + quoted(raw), example);
  if (number == 0 && (column.name != "t" || column.unit != "s")) {
    text.fail(raw.data(), "the first column " + quoted(raw),
              "'t [s]', time in seconds, as the first");
  }
  const auto known = std::ranges::find(kKnownColumns, column.name, &KnownColumn::name);
  if (known != kKnownColumns.end() && known->unit != column.unit) {
    text.fail(raw.data(), quoted(raw),
              "'" + column.name + " [" + std::string(known->unit) + "]', the unit this name has");
  }
  return column;
}

// Column titles; the first one is the time.
std::vector<Column> parse_header(const CsvText& text, std::string_view line) {
  if (line.find(',') == std::string_view::npos && line.find(';') != std::string_view::npos) {
    text.fail(line.data() + line.find(';'), "';' between columns", "','");
  }
  std::vector<Column> columns;
  std::size_t start = 0;
  while (true) {
    const std::size_t comma = std::min(line.find(',', start), line.size());
    const std::string_view cell = line.substr(start, comma - start);
    Column column = parse_title(text, cell, columns.size());
    if (std::ranges::find(columns, column.name, &Column::name) != columns.end()) {
      text.fail(cell.data(), "a second column '" + column.name + "'", "every name once");
    }
    columns.push_back(std::move(column));
    if (comma == line.size()) break;
    start = comma + 1;
  }
  if (columns.size() < 2) {
    text.fail(line.data(), "no column except the time", "'t [s]' and at least one 'name [unit]'");
  }
  return columns;
}

double parse_number(const CsvText& text, std::string_view cell, const Column& column) {
  const std::string_view raw = trimmed(cell);
  std::string_view digits = raw;
  if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
  double number = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const bool whole = end == digits.data() + digits.size();
  if (error == std::errc() && whole && std::isfinite(number)) return number;
  const std::string want = "a finite number in column '" + title(column) + "'";
  if (raw.empty())
    text.fail(cell.data(), "an empty cell", want + "; leave out rows without a value");
  if (error == std::errc::result_out_of_range && whole) {
    text.fail(raw.data(), quoted(raw),
              "a number that a double can hold, in column '" + title(column) + "'");
  }
  text.fail(raw.data(), quoted(raw), want);
}

// True for a row that is in the columns already, as a recorder writes a block of rows twice.
bool repeats(const std::vector<double>& row, const std::vector<Column>& columns) {
  const std::vector<double>& time_s = columns[0].values;
  const auto found = std::ranges::lower_bound(time_s, row[0]);
  if (found == time_s.end() || *found != row[0]) return false;
  const auto at = static_cast<std::size_t>(found - time_s.begin());
  for (std::size_t i = 1; i < columns.size(); ++i) {
    if (columns[i].values[at] != row[i]) return false;
  }
  return true;
}

[[noreturn]] void fail_early(const CsvText& text, std::string_view cell, double before_s) {
  std::array<char, 32> before{};
  const auto end = std::to_chars(before.begin(), before.end(), before_s).ptr;
  text.fail(cell.data(), "time " + std::string(cell) + " s",
            "more than " + std::string(before.data(), end) + " s, the time of the row before");
}

// False: it repeats an earlier row.  @param row  of the last line; its memory is used again
bool parse_row(const CsvText& text, std::string_view line, std::vector<double>& row,
               std::vector<Column>& columns) {
  row.clear();
  std::size_t start = 0;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (start > line.size()) {
      text.fail(line.data() + line.size(), "a row of " + std::to_string(i) + " cells",
                std::to_string(columns.size()) + ", as the header has");
    }
    const std::size_t comma = std::min(line.find(',', start), line.size());
    const std::string_view cell = line.substr(start, comma - start);
    row.push_back(parse_number(text, cell, columns[i]));
    start = comma + 1;
  }
  if (start <= line.size()) {
    text.fail(line.data() + start - 1, "more than " + std::to_string(columns.size()) + " cells",
              std::to_string(columns.size()) + ", as the header has");
  }
  const std::vector<double>& time_s = columns[0].values;
  if (!time_s.empty() && !(row[0] > time_s.back())) {
    if (repeats(row, columns)) return false;
    fail_early(text, trimmed(line.substr(0, line.find(','))), time_s.back());
  }
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i].values.push_back(row[i]);
  return true;
}

}  // namespace

Recording parse_csv(std::string_view text, const std::string& source) {
  if (text.find('\0') != std::string_view::npos) {
    throw ConfigError(source, "binary data", "CSV text in UTF-8");
  }
  CsvText csv(text, source);
  std::string_view line;
  if (!csv.next_line(line) || trimmed(line).empty()) {
    throw ConfigError(source + ":1:1", "an empty first line", "a header 't [s],name [unit],...'");
  }
  std::vector<Column> columns = parse_header(csv, line);
  const auto rows = static_cast<std::size_t>(std::ranges::count(csv.rest(), '\n')) + 1;
  for (Column& column : columns) column.values.reserve(rows);
  Recording recording;
  std::vector<double> row;
  while (csv.next_line(line)) {
    if (trimmed(line).empty()) {
      if (csv.rest().find_first_not_of(" \t\r\n") == std::string_view::npos) break;
      csv.fail(line.data(), "an empty line", "a row; leave out rows without a value altogether");
    }
    if (!parse_row(csv, line, row, columns)) ++recording.repeated_rows;
  }
  if (columns[0].values.size() < 2) {
    throw ConfigError(source, std::to_string(columns[0].values.size()) + " rows",
                      "at least 2 below the header");
  }
  recording.source = source;
  recording.time_s = std::move(columns[0].values);
  columns.erase(columns.begin());
  recording.columns = std::move(columns);
  estimate_timing(recording);
  return recording;
}

std::string_view known_unit(std::string_view name) {
  const auto known = std::ranges::find(kKnownColumns, name, &KnownColumn::name);
  return known == kKnownColumns.end() ? std::string_view() : known->unit;
}

std::string to_csv(const Recording& recording) {
  std::string text = "t [s]";
  for (const Column& column : recording.columns) text += "," + title(column);
  text += '\n';
  std::array<char, 32> digits{};
  const auto append = [&](double number) {
    text.append(digits.data(), std::to_chars(digits.begin(), digits.end(), number).ptr);
  };
  for (std::size_t row = 0; row < recording.row_count(); ++row) {
    append(recording.time_s[row]);
    for (const Column& column : recording.columns) {
      text += ',';
      append(column.values[row]);
    }
    text += '\n';
  }
  return text;
}

}  // namespace stillhand::recording
