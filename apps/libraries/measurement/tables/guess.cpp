// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/guess.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "apps/libraries/measurement/tables/choice.hpp"
#include "apps/libraries/report/command_line.hpp"

namespace stillhand::measurement {
namespace {

// A sign that a title is about this channel.
struct Hint {
  std::string_view word;  // beginning of a word of the title
  std::string_view name;
};
// "axis": x, y or z follows, in the word or behind it.
constexpr std::array<Hint, 36> kHints{{{"time", "t"},
                                       {"zeit", "t"},
                                       {"temps", "t"},
                                       {"timestamp", "t"},
                                       {"seconds", "t"},
                                       {"clock", "t"},
                                       {"uhrzeit", "t"},
                                       {"sec", "t"},
                                       {"t", "t"},
                                       {"acc", "axis"},
                                       {"beschl", "axis"},
                                       {"linear_acceleration", "axis"},
                                       {"ax", "a_x"},
                                       {"ay", "a_y"},
                                       {"az", "a_z"},
                                       {"a_x", "a_x"},
                                       {"a_y", "a_y"},
                                       {"a_z", "a_z"},
                                       {"force", "f"},
                                       {"kraft", "f"},
                                       {"wrench", "f"},
                                       {"fy", "f"},
                                       {"f", "f"},
                                       {"motor", "f_motor"},
                                       {"roll", "roll"},
                                       {"angle", "theta"},
                                       {"winkel", "theta"},
                                       {"theta", "theta"},
                                       {"omega", "omega"},
                                       {"gyro", "omega"},
                                       {"angular_velocity", "omega"},
                                       {"target", "x_r"},
                                       {"reference", "x_r"},
                                       {"cursor", "x_p"},
                                       {"x_r", "x_r"},
                                       {"x_p", "x_p"}}};

bool is_small_letter(char c) { return c >= 'a' && c <= 'z'; }

// Place where a word of the title begins with the hint's word; short hints must be the whole word.
std::size_t find_word(const std::string& title, std::string_view word) {
  for (std::size_t at = title.find(word); at != std::string::npos; at = title.find(word, at + 1)) {
    const bool begins = at == 0 || !is_small_letter(title[at - 1]);
    const std::size_t end = at + word.size();
    const bool ends = end == title.size() || !(is_small_letter(title[end]) || title[end] == '_');
    if (begins && (word.size() > 2 || ends)) return at;
  }
  return std::string::npos;
}

// The axis in the rest of a title: its last x, y or z that stands alone, else ends a word; y, the
// lateral one, where it states none.
char axis_in(const std::string& rest) {
  for (const bool alone : {true, false}) {
    for (std::size_t i = rest.size(); i-- > 0;) {
      const bool begins = i == 0 || !is_small_letter(rest[i - 1]);
      const bool ends = i + 1 == rest.size() || !is_small_letter(rest[i + 1]);
      if (ends && (begins || !alone) && rest[i] >= 'x' && rest[i] <= 'z') return rest[i];
    }
  }
  return 'y';
}

// The column's unit where it has one that fits, or the title ends with one ("acc_g", "angle deg");
// else the channel's own, for a person to correct.
std::string unit_for(const ColumnHead& column, const std::string& name) {
  std::string wanted = si_unit(name);
  const std::size_t end = column.name.find_last_of("_ ");
  const std::string last = end == std::string::npos ? "" : column.name.substr(end + 1);
  for (const std::string& unit : {column.unit, last}) {
    if (!unit.empty() && unit_conversion(unit, {}, wanted)) return unit;
  }
  return wanted;
}

}  // namespace

std::string reference_to(const TableHead& head, std::size_t number) {
  const std::string& title = head.columns[number].title;
  return std::ranges::count(head.columns, title, &ColumnHead::title) == 1
             ? title
             : "#" + std::to_string(number + 1);
}

bool is_bookkeeping(const ColumnHead& column) {
  const std::string title = lower_case(column.name);
  return title.ends_with("sequence") || title.ends_with("nanosec") ||
         title.ends_with("stamp_sec") || title.ends_with("stamp.sec") ||
         title.find("covariance") != std::string::npos;
}

std::optional<ColumnWish> guess_column(const ColumnHead& column, std::size_t number,
                                       const TableHead& head) {
  if (is_bookkeeping(column)) return std::nullopt;
  const std::string title = lower_case(column.name);
  for (const Hint& hint : kHints) {
    const std::size_t at = find_word(title, hint.word);
    if (at == std::string::npos) continue;
    ColumnWish wish;
    wish.from = reference_to(head, number);
    const char axis = axis_in(title.substr(at));
    wish.name = hint.name == "axis" ? std::string("a_") + axis : std::string(hint.name);
    // The lateral one of several forces.
    if (wish.name == "f" && axis != 'y') continue;
    // A unit of another quantity: the mapping would be refused.
    if (!column.unit.empty() && !unit_conversion(column.unit, {}, si_unit(wish.name))) continue;
    wish.unit = unit_for(column, wish.name);
    return wish;
  }
  return std::nullopt;
}

namespace {

// Of a title with a path, '/stick/wrench.force_y', its last part says what the column is, and the
// rest what the sensor is; a part that is a channel's name says it best.
enum class Part { kName, kLast, kWhole };

std::optional<ColumnWish> guess_part(const TableHead& head, std::size_t number, Part part) {
  ColumnHead column = head.columns[number];
  if (part == Part::kWhole) return guess_column(column, number, head);
  if (is_bookkeeping(column)) return std::nullopt;
  column.name.erase(0, column.name.find_last_of("/.") + 1);
  std::optional<ColumnWish> wish = guess_column(column, number, head);
  if (part == Part::kName && wish && wish->name != lower_case(column.name)) wish.reset();
  return wish;
}

}  // namespace

Mapping guess_mapping(const TableHead& head) {
  std::vector<std::pair<std::size_t, ColumnWish>> found;
  for (const Part part : {Part::kName, Part::kLast, Part::kWhole}) {
    for (std::size_t i = 0; i < head.columns.size(); ++i) {
      std::optional<ColumnWish> wish = guess_part(head, i, part);
      if (!wish || (wish->name == "t" && head.has_times)) continue;
      const bool taken = std::ranges::any_of(found, [&](const auto& other) {
        return other.first == i || other.second.name == wish->name;
      });
      if (!taken) found.emplace_back(i, std::move(*wish));
    }
  }
  std::ranges::sort(found, {}, &std::pair<std::size_t, ColumnWish>::first);
  Mapping out;
  for (auto& [number, wish] : found) out.columns.push_back(std::move(wish));
  return out;
}

std::string command_words(const Mapping& mapping) {
  std::string words = "--map";
  for (const ColumnWish& wish : mapping.columns) {
    words += " " + report::in_shell_quotes(wish_text(wish));
  }
  if (mapping.rate_hz) words += fmt::format(" --sample-rate {}", *mapping.rate_hz);
  return words;
}

}  // namespace stillhand::measurement
