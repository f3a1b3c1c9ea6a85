// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/suggestion.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "apps/libraries/measurement/tables/choice.hpp"
#include "apps/libraries/measurement/tables/guess.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/signal/moments.hpp"

namespace stillhand::measurement {
namespace {

// Time stamps without a unit that step by 1 or more are more likely ms, us or ns than seconds.
// Empty: each step is 1, which a counter does too.
std::string likely_time_unit(TableFile& file, const std::string& from) {
  try {
    const std::vector<double> time = file.read({find_column(file.head(), from)}).values.at(0);
    std::vector<double> steps;
    for (std::size_t i = 1; i < time.size(); ++i) {
      if (time[i] > time[i - 1]) steps.push_back(time[i] - time[i - 1]);
    }
    if (steps.empty()) return "s";
    if (std::ranges::all_of(steps, [](double step) { return step == 1.0; })) return {};
    const double step = signal::middle_of(steps);
    return step < 1.0 ? "s" : step < 1e3 ? "ms" : step < 1e6 ? "us" : "ns";
  } catch (const ConfigError&) {
    return "s";  // a guess for a message about something else
  }
}

// A column without a unit may hold anything.
bool fits(const ColumnHead& column, const std::string& name) {
  return column.unit.empty() || unit_conversion(column.unit, {}, si_unit(name));
}

// Columns that resemble nothing are suggested as what is still missing.
void fill_guess(const TableHead& head, bool timed, Mapping& guess) {
  std::vector<std::string> wanted{"a_y", "f"};
  if (!timed) wanted.insert(wanted.begin(), "t");
  for (const std::string& name : wanted) {
    if (std::ranges::find(guess.columns, name, &ColumnWish::name) != guess.columns.end()) continue;
    for (std::size_t i = 0; i < head.columns.size(); ++i) {
      const std::string from = reference_to(head, i);
      if (!fits(head.columns[i], name) || is_bookkeeping(head.columns[i]) ||
          std::ranges::find(guess.columns, from, &ColumnWish::from) != guess.columns.end())
        continue;
      ColumnWish wish{from, name, si_unit(name), {}};
      guess.columns.insert(name == "t" ? guess.columns.begin() : guess.columns.end(), wish);
      break;
    }
  }
}

// A name of a channel with a unit of another quantity: no mapping mends that.
void refuse_other_unit(const TableHead& head) {
  for (const ColumnHead& column : head.columns) {
    const std::string unit = si_unit(column.name);
    if (unit.empty() || fits(column, column.name)) continue;
    throw ConfigError(head.path, "the unit " + column.unit + " of '" + column.title + "'",
                      "a unit of " + column.name + ", such as " + unit +
                          ": correct the title, or map the column with a gain and its unit");
  }
}

void refuse_second_title(TableFile& file) {
  const auto& columns = file.head().columns;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const auto first = std::ranges::find(columns, columns[i].name, &ColumnHead::name);
    const auto place = static_cast<std::size_t>(first - columns.begin());
    if (place == i || columns[i].unit.empty() || first->unit.empty()) continue;
    const std::string places =
        " (#" + std::to_string(place + 1) + " and #" + std::to_string(i + 1) + ")";
    throw ConfigError(file.head().path,
                      (first->title == columns[i].title ? "the title '" + first->title + "' twice"
                                                        : "the name '" + first->name + "' twice") +
                          places,
                      "every name once; " + words_to_add(file));
  }
}

}  // namespace

Mapping suggestion(TableFile& file) {
  const TableHead& head = file.head();
  Mapping guess = guess_mapping(head);
  fill_guess(head, head.has_times || head.rate_hz > 0.0, guess);
  const auto time = std::ranges::find(guess.columns, "t", &ColumnWish::name);
  if (time != guess.columns.end() && time->unit == "s" &&
      head.columns[find_column(head, time->from)].unit.empty()) {
    time->unit = likely_time_unit(file, time->from);
    if (time->unit.empty()) guess.columns.erase(time);
  }
  return guess;
}

std::string words_to_add(TableFile& file) {
  const TableHead& head = file.head();
  const Mapping guess = suggestion(file);
  const bool all_used = guess.columns.size() >= head.columns.size();
  for (const char* name : {"a_y", "f"}) {
    if (all_used ||
        std::ranges::find(guess.columns, name, &ColumnWish::name) != guess.columns.end())
      continue;
    return std::string("no other column has a unit of ") + name + ", such as " + si_unit(name) +
           "; --input and --output name other channels";
  }
  const bool timed =
      head.has_times || head.rate_hz > 0.0 ||
      std::ranges::find(guess.columns, "t", &ColumnWish::name) != guess.columns.end();
  return "if they are these, add " + in_one_line(command_words(guess)) +
         (timed ? "" : " --sample-rate HZ") + " (or --map-file FILE, to be asked)";
}

void refuse_titles(TableFile& file) {
  refuse_other_unit(file.head());
  refuse_second_title(file);
  throw ConfigError(file.head().path, "the columns " + titles_of(file.head()),
                    "'t [s]' and 'name [unit]'; " + words_to_add(file));
}

}  // namespace stillhand::measurement
