// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "services/core/contract/config_error.hpp"
#include "services/files/settings/nearest.hpp"

namespace stillhand::measurement {
namespace {

constexpr std::size_t kMostTitles = 12;  // of a message

// One way of naming a column: as long as it is the only one of that name.
template <typename Same>
std::optional<std::size_t> only_one(const TableHead& head, const Same& same) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < head.columns.size(); ++i) {
    if (!same(head.columns[i])) continue;
    if (found) return std::nullopt;
    found = i;
  }
  return found;
}

}  // namespace

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return text;
}

std::string titles_of(const TableHead& head) {
  std::string text;
  for (std::size_t i = 0; i < std::min(head.columns.size(), kMostTitles); ++i) {
    text += (i == 0 ? "'" : ", '") + head.columns[i].title + "'";
  }
  if (head.columns.size() > kMostTitles) {
    text += fmt::format(" and {} more", head.columns.size() - kMostTitles);
  }
  return text;
}

std::size_t find_column(const TableHead& head, const std::string& from) {
  auto found = only_one(head, [&](const ColumnHead& column) { return column.title == from; });
  if (!found) found = only_one(head, [&](const ColumnHead& column) { return column.name == from; });
  if (!found && from.starts_with('#')) {
    for (std::size_t i = 0; i < head.columns.size(); ++i) {
      if (from.substr(1) == std::to_string(i + 1)) return i;
    }
  }
  if (!found) {
    const std::string wanted = lower_case(from);
    found = only_one(head, [&](const ColumnHead& column) {
      return lower_case(column.title) == wanted || lower_case(column.name) == wanted;
    });
  }
  if (found) return *found;
  std::vector<std::string_view> titles;
  for (const ColumnHead& column : head.columns) titles.push_back(column.title);
  const auto same = std::ranges::count(titles, from);
  std::string noted;  // a column may be there, and not be read
  for (const std::string& note : head.notes) noted += " (" + in_one_line(note) + ")";
  if (!head.loss.empty()) noted += " (" + in_one_line(head.loss) + ")";
  throw ConfigError("--map",
                    same > 1 ? fmt::format("'{}', the title of {} columns", from, same)
                             : "'" + from + "', which is no column of " + head.path,
                    same > 1 ? "its place, such as '#2'"
                             : "'" + in_one_line(settings::nearest(from, titles)) +
                                   "' or another of " + in_one_line(titles_of(head)) + noted);
}

Choice choose(const TableHead& head, const Mapping& mapping) {
  Choice out;
  for (std::size_t i = 0; i < mapping.columns.size(); ++i) {
    const ColumnWish& wish = mapping.columns[i];
    for (std::size_t j = 0; j < i; ++j) {
      if (mapping.columns[j].name != wish.name) continue;
      throw ConfigError("--map", "a second '" + wish.name + "'", "every channel once");
    }
    if (wish.name == "t") out.time = i;
    out.columns.push_back(find_column(head, wish.from));
  }
  return out;
}

std::pair<std::string, std::string> units_of(const ColumnHead& column, const ColumnWish& wish) {
  const std::string si = si_unit(wish.name);
  const std::string of_angles = si == "rad" ? column.angle_unit
                                : si == "rad/s" && !column.angle_unit.empty()
                                    ? column.angle_unit + "/s"
                                    : "";
  // Of a title and a line of units that contradict each other, the mapping says which is right.
  const bool decides = !column.unit_below.empty() && !wish.unit.empty();
  const std::string stated = decides ? wish.unit : column.unit.empty() ? of_angles : column.unit;
  std::string from = stated.empty() ? wish.unit : stated;
  if (!si.empty()) {
    // A unit that is not the channel's own says what the values are, whatever the title says.
    if (!wish.unit.empty() && wish.unit != si) from = wish.unit;
    return {from.empty() ? si : from, si};
  }
  if (!wish.gain.unit.empty() && !column.unit.empty()) return {from, wish.unit};
  return {from, wish.unit.empty() ? from : wish.unit};
}

UnitConversion conversion_of(const TableHead& head, const ColumnHead& column,
                             const ColumnWish& wish) {
  if (!column.unit_below.empty() && wish.unit.empty()) {
    throw ConfigError(head.path + ":" + std::to_string(column.unit_line) + ":1",
                      "[" + column.unit_below + "] below the title '" + column.title + "'",
                      "one unit of each column; a --map that states it, 'TITLE=NAME [UNIT]', says "
                      "which of the two is right");
  }
  const auto [from, to] = units_of(column, wish);
  // A unit in the mapping that is not the title's must measure the same thing.
  const bool stated_twice = !column.unit.empty() && column.unit_below.empty() &&
                            !wish.unit.empty() && wish.gain.unit.empty();
  auto conversion = unit_conversion(from, wish.gain, to);
  if (stated_twice && !unit_conversion(column.unit, {}, wish.unit)) conversion.reset();
  if (conversion) return *conversion;
  throw ConfigError(head.path + ", '" + column.title + "'",
                    "values in [" + from + "] for '" + wish_text(wish) + "'",
                    "a unit of " + in_one_line(wish.name) +
                        (to.empty() ? "" : " [" + in_one_line(to) + "]") +
                        ", or a gain with its unit, such as '* 22.5 [N/V]'");
}

}  // namespace stillhand::measurement
