// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/text_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "apps/libraries/measurement/tables/text_cells.hpp"
#include "apps/libraries/measurement/tables/text_layout.hpp"
#include "apps/libraries/measurement/tables/titles.hpp"
#include "apps/libraries/measurement/tables/units.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::measurement {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

// "-" and "1" stand in a line of units for none.
bool says_a_unit(const std::string& text) { return text != "%" && is_unit(text); }

bool same_unit(const std::string& a, const std::string& b) {
  const auto conversion = unit_conversion(a, {}, b);
  return conversion && conversion->is_identity();
}

// The unit of a line of units counts where the title has none, or brackets around another word.
void take_unit_below(const TextLayout& layout, std::size_t number, ColumnHead& column) {
  const std::string& below = number < layout.units.size() ? layout.units[number] : column.unit;
  if (!says_a_unit(column.unit)) {
    if (column.unit.empty() || says_a_unit(below)) column.unit = below;
  } else if (says_a_unit(below) && !same_unit(below, column.unit)) {
    column.unit_below = below;
    column.unit_line = layout.units_line;
  }
}

TableHead head_of_text(const TextLayout& layout, const std::string& path, const std::string& note) {
  TableHead head;
  if (!note.empty()) head.notes.push_back(note);
  head.path = path;
  head.rate_hz = layout.rate_hz;
  head.form = "Text table with " + separator_name(layout.form.separator) +
              " between columns and '" + std::string(1, layout.form.decimal) + "' as decimal sign";
  for (std::size_t i = 0; i < layout.titles.size(); ++i) {
    const Title title = parse_title(layout.titles[i]);
    head.columns.push_back(
        {layout.titles[i], title.name, title.unit, 0, layout.in_degrees ? "degree" : ""});
    take_unit_below(layout, i, head.columns.back());
  }
  return head;
}

class TextTable : public TableFile {
 public:
  TextTable(DecodedText text, TextLayout layout, const std::string& path, std::size_t most_values)
      : TableFile(head_of_text(layout, path, text.note)),
        text_(std::move(text.text)),
        layout_(std::move(layout)),
        most_values_(most_values) {}

  RawColumns read(const std::vector<std::size_t>& columns) override {
    check_size(columns.size());
    RawColumns out;
    out.values.resize(columns.size());
    lines_.clear();
    std::vector<std::string_view> cells;
    std::size_t short_rows = 0;
    TextLines walk(text_, layout_.first_offset, layout_.first_line);
    TextLine line;
    while (walk.next(line)) {
      if (line.text.find_first_not_of(" \t") == std::string_view::npos) continue;
      if (is_comment(line.text)) continue;
      split(line.text, layout_.form.separator, cells);
      if (cells.size() < layout_.titles.size() && !line.ended) {
        out.notes.emplace_back("The last line is cut off and left out.");
        break;
      }
      if (const std::size_t lines = lines_of_text(line); lines > 0) {
        out.notes.push_back(std::to_string(lines) + (lines == 1 ? " line" : " lines") +
                            " of text behind the rows left out, from line " +
                            std::to_string(line.number) + " on.");
        break;
      }
      short_rows += cells.size() < layout_.titles.size() ? 1u : 0u;
      take_row(line, cells, columns, out);
    }
    if (short_rows > 0) {
      out.notes.push_back(std::to_string(short_rows) + (short_rows == 1 ? " row" : " rows") +
                          " with fewer cells than titles: the others count as missing.");
    }
    return out;
  }

  [[nodiscard]] std::string place(std::size_t row) const override {
    return head().path + ":" + std::to_string(row < lines_.size() ? lines_[row] : 0) + ":1";
  }

 private:
  // Lines without any number from this one to the end of the file, where a logger says that it has
  // ended; 0: this one has a number, or more than a few lines follow.
  [[nodiscard]] std::size_t lines_of_text(const TextLine& first) const {
    constexpr std::size_t kMost = 20;
    std::vector<std::string_view> cells;
    std::size_t count = 0;
    TextLines walk(text_, first.offset, first.number);
    for (TextLine line; walk.next(line);) {
      split(line.text, layout_.form.separator, cells);
      double number = 0.0;
      const bool has_number = std::ranges::any_of(cells, [&](std::string_view cell) {
        return read_cell(cell, layout_.form.decimal, number) == CellContent::kNumber;
      });
      const bool blank = line.text.find_first_not_of(" \t,;") == std::string_view::npos;
      if (has_number || (blank && count == 0) || ++count > kMost) return 0;
    }
    return count;
  }

  void check_size(std::size_t columns) const {
    const auto rows = static_cast<std::size_t>(std::ranges::count(text_, '\n'));
    if (columns > 0 && rows > most_values_ / columns) {
      throw ConfigError(head().path,
                        std::to_string(rows) + " rows of " + std::to_string(columns) + " channels",
                        "at most " + std::to_string(most_values_) +
                            " values; use a part of the file, fewer columns or a lower rate");
    }
  }

  [[noreturn]] void fail(const TextLine& line, std::string_view at, const std::string& got,
                         const std::string& want) const {
    const auto column = static_cast<std::size_t>(at.data() - line.text.data()) + 1;
    throw ConfigError(
        head().path + ":" + std::to_string(line.number) + ":" + std::to_string(column), got, want);
  }

  void take_row(const TextLine& line, const std::vector<std::string_view>& cells,
                const std::vector<std::size_t>& columns, RawColumns& out) {
    const std::size_t wanted = layout_.titles.size();
    if (cells.size() > wanted) {
      const bool last_is_empty = cells.size() == wanted + 1 && plain_cell(cells.back()).empty();
      if (!last_is_empty && cells.size() > wanted + layout_.comment_cells) {
        fail(line, cells[wanted], "more than " + std::to_string(wanted) + " cells",
             std::to_string(wanted) + ", as the titles are, with " +
                 separator_name(layout_.form.separator) + " between them");
      }
    }
    for (std::size_t i = 0; i < columns.size(); ++i) {
      double number = kNothing;
      if (columns[i] < cells.size()) {
        const std::string_view cell = cells[columns[i]];
        const CellContent content = read_cell(cell, layout_.form.decimal, number);
        if (content == CellContent::kText) {
          fail(line, cell, in_quotes(plain_cell(cell)),
               "a finite number in column " + in_quotes(layout_.titles[columns[i]]));
        }
      }
      out.values[i].push_back(number);
    }
    lines_.push_back(static_cast<std::uint32_t>(line.number));
  }

  std::string text_;
  TextLayout layout_;
  std::size_t most_values_;
  std::vector<std::uint32_t> lines_;  // of each row
};

}  // namespace

std::unique_ptr<TableFile> text_table(DecodedText text, const std::string& path,
                                      const TextForm& form, std::size_t most_values) {
  TextLayout layout = find_layout(text.text, form, path);
  return std::make_unique<TextTable>(std::move(text), std::move(layout), path, most_values);
}

}  // namespace stillhand::measurement
