// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/apply_mapping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/libraries/measurement/tables/choice.hpp"
#include "apps/libraries/measurement/tables/guess.hpp"
#include "apps/libraries/measurement/tables/suggestion.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::measurement {
namespace {

// "a_y from 'acc [g]' (times 9.80665)"
std::string note_of(const ColumnHead& column, const ColumnWish& wish,
                    const UnitConversion& conversion) {
  std::string text = wish.name + " from '" + column.title + "'";
  const double times = conversion.factor / conversion.divisor * conversion.scale / conversion.parts;
  if (times != 1.0) text += fmt::format(" (times {:.6g})", times);
  return text;
}

// Rows without a value in one of the columns are left out.
void leave_out_empty(const Mapping& mapping, std::vector<std::vector<double>>& values,
                     std::vector<std::size_t>& kept, std::vector<std::string>& notes) {
  const std::size_t rows = values.empty() ? 0 : values[0].size();
  std::vector<std::size_t> missing(values.size(), 0);
  for (std::size_t row = 0; row < rows; ++row) {
    bool whole = true;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isnan(values[i][row])) continue;
      ++missing[i];
      whole = false;
    }
    if (whole) kept.push_back(row);
  }
  if (kept.size() == rows) return;
  std::string which;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (missing[i] == 0) continue;
    which +=
        fmt::format("{}{} in {}", which.empty() ? "" : ", ", missing[i], mapping.columns[i].name);
  }
  notes.push_back(fmt::format("{} of {} rows lack a value ({}): they are treated as missing.",
                              rows - kept.size(), rows, which));
}

// `stillhand export` writes a topic as one table.  A fit over it would mix the trials, with and
// without motion, peg and motor, and give a good-looking number.
void refuse_samples_of_session(const TableHead& head) {
  const auto has = [&head](std::string_view member) {
    return std::ranges::any_of(head.columns, [member](const ColumnHead& column) {
      return std::string_view(column.name).ends_with(member);
    });
  };
  if (!has("acquired_ns") || !has("accel_y_m_s2")) return;
  throw ConfigError(
      head.path, "the samples of a session, all trials in one table",
      "the recording that they were exported from; --trial N takes one of its trials");
}

// The mapping that counts, with everything that it needs.
Mapping complete(TableFile& file, const Mapping& asked) {
  const TableHead& head = file.head();
  refuse_samples_of_session(head);
  Mapping mapping = asked;
  if (mapping.columns.empty()) mapping.columns = mapping_of_titles(head, asked).columns;
  if (mapping.columns.empty()) refuse_titles(file);
  const bool timed =
      std::ranges::find(mapping.columns, "t", &ColumnWish::name) != mapping.columns.end();
  if (timed && mapping.rate_hz) {
    throw ConfigError("--sample-rate",
                      fmt::format("{} next to a column of times", *mapping.rate_hz), "one of them");
  }
  if (!timed && !mapping.rate_hz && head.rate_hz <= 0.0 && !head.has_times) {
    throw ConfigError(head.path, "no time among " + titles_of(head),
                      "--map 'TITLE=t [s]' too, or --sample-rate HZ");
  }
  if (mapping.columns.size() < (timed ? 2U : 1U)) {
    if (asked.columns.empty()) {
      throw ConfigError(head.path, "no column except the time",
                        "'t [s]' and at least one 'name [unit]'");
    }
    throw ConfigError("--map", "no channel except the time", "at least one 'TITLE=NAME [UNIT]'");
  }
  return mapping;
}

std::vector<double> times_of(const TableHead& head, const Mapping& mapping, const Choice& choice,
                             RawColumns& raw, std::vector<std::string>& notes) {
  if (choice.time) return raw.values[*choice.time];
  if (!mapping.rate_hz && head.has_times) return std::move(raw.time_s);
  const double rate_hz = mapping.rate_hz.value_or(head.rate_hz);
  std::vector<double> time_s(raw.values[0].size());
  for (std::size_t i = 0; i < time_s.size(); ++i) time_s[i] = static_cast<double>(i) / rate_hz;
  notes.push_back(fmt::format("Times by the sample rate, {:.9g} Hz.", rate_hz));
  return time_s;
}

// [Hz] from the first row of the second block to that of the last one; 0: there are not as many.
double rate_of_blocks(const std::vector<double>& time_s) {
  const auto changes = [](double a, double b) { return a != b; };
  const auto second = std::ranges::adjacent_find(time_s, changes);
  const auto last = std::adjacent_find(time_s.rbegin(), time_s.rend(), changes);
  if (second == time_s.end()) return 0.0;
  const auto rows = (last.base() - time_s.begin()) - (second + 1 - time_s.begin());
  const double span_s = time_s.back() - *(second + 1);
  return span_s > 0.0 ? static_cast<double>(rows) / span_s : 0.0;
}

// Moves the rows that are kept into the recording.  A row that repeats an earlier one, as a
// recorder writes a block of rows twice, is left out.
class RowTaker {
 public:
  RowTaker(const TableFile& file, const Mapping& mapping, const Choice& choice)
      : file_(file), mapping_(mapping), choice_(choice) {
    rows_.source = file.head().path;
  }

  recording::Recording take(const std::vector<double>& time_s,
                            const std::vector<std::vector<double>>& values,
                            const std::vector<std::size_t>& kept) {
    std::vector<std::size_t> rows;
    rows.reserve(kept.size());
    for (const std::size_t row : kept) {
      for (std::size_t i = 0; i < values.size(); ++i) check_finite(row, i, values[i][row]);
      if (!rows.empty() && !(time_s[row] > time_s[rows.back()])) {
        const auto same = std::ranges::lower_bound(
            rows, time_s[row], {}, [&](std::size_t earlier) { return time_s[earlier]; });
        if (same == rows.end() || !repeats(values, *same, row)) {
          fail_order(time_s, rows.back(), row);
        }
        ++rows_.repeated_rows;
        continue;
      }
      rows.push_back(row);
    }
    if (rows.size() < 2) {
      throw ConfigError(rows_.source, fmt::format("{} rows with every value", rows.size()),
                        "at least 2");
    }
    const auto part = [&](const std::vector<double>& all) {
      std::vector<double> out(rows.size());
      for (std::size_t i = 0; i < rows.size(); ++i) out[i] = all[rows[i]];
      return out;
    };
    rows_.time_s = part(time_s);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (choice_.time == i) continue;
      const auto [from, to] =
          units_of(file_.head().columns[choice_.columns[i]], mapping_.columns[i]);
      rows_.columns.push_back({mapping_.columns[i].name, to.empty() ? "-" : to, part(values[i])});
    }
    recording::estimate_timing(rows_);
    return std::move(rows_);
  }

 private:
  void check_finite(std::size_t row, std::size_t column, double value) const {
    if (std::isfinite(value)) return;
    throw ConfigError(file_.place(row),
                      fmt::format("{} in {}", value, mapping_.columns[column].name),
                      "finite numbers; an empty cell for a value that is not there");
  }
  [[noreturn]] void fail_order(const std::vector<double>& time_s, std::size_t before,
                               std::size_t row) const {
    std::string want = fmt::format("more than {} s, the time of the row before", time_s[before]);
    if (time_s[row] == time_s[before]) {
      const double rate_hz = rate_of_blocks(time_s);
      want = fmt::format(
          "{}; for rows that share a stamp in blocks, no column of times but their rate{}", want,
          rate_hz > 0.0 ? fmt::format(", about --sample-rate {:.4g}", rate_hz)
                        : ": --sample-rate HZ");
    }
    throw ConfigError(file_.place(row), fmt::format("time {} s", time_s[row]), want);
  }
  static bool repeats(const std::vector<std::vector<double>>& values, std::size_t row,
                      std::size_t other) {
    return std::ranges::all_of(values, [&](const auto& all) { return all[row] == all[other]; });
  }

  const TableFile& file_;
  const Mapping& mapping_;
  const Choice& choice_;
  recording::Recording rows_;
};

}  // namespace

Mapping mapping_of_titles(const TableHead& head, const Mapping& asked) {
  Mapping out;
  bool timed = head.has_times || head.rate_hz > 0.0 || asked.rate_hz;
  for (std::size_t i = 0; i < head.columns.size(); ++i) {
    const ColumnHead& column = head.columns[i];
    const std::string lower = lower_case(column.name);
    const bool is_time =
        (lower == "t" || lower == "time") && unit_conversion(column.unit, {}, "s").has_value();
    // "F [N]" is f, but "T [K]" is no time.
    const bool known = !si_unit(lower).empty() && unit_conversion(column.unit, {}, si_unit(lower));
    std::string name = is_time ? "t" : known ? lower : column.name;
    const bool fits = si_unit(name).empty() || unit_conversion(column.unit, {}, si_unit(name));
    const bool twice = std::ranges::find(out.columns, name, &ColumnWish::name) != out.columns.end();
    if (column.unit.empty() || !fits || twice) return {};
    timed = timed || is_time;
    out.columns.push_back({reference_to(head, i), std::move(name), {}, {}});
  }
  return timed ? out : Mapping{};
}

MappedRows apply_mapping(TableFile& file, const Mapping& asked) {
  const TableHead& head = file.head();
  const Mapping mapping = complete(file, asked);
  const Choice choice = choose(head, mapping);
  MappedRows out;
  std::vector<UnitConversion> conversions;
  std::string sources;
  for (std::size_t i = 0; i < choice.columns.size(); ++i) {
    const ColumnHead& column = head.columns[choice.columns[i]];
    conversions.push_back(conversion_of(head, column, mapping.columns[i]));
    sources += (i == 0 ? "" : ", ") + note_of(column, mapping.columns[i], conversions[i]);
  }
  RawColumns raw = file.read(choice.columns);
  out.back_steps = std::move(raw.back_steps);
  out.notes = head.notes;
  out.loss = head.loss;
  if (!head.loss.empty()) out.notes.push_back("Loss: " + head.loss + ".");
  out.notes.push_back(head.form + ": " + sources + ".");
  out.notes.insert(out.notes.end(), raw.notes.begin(), raw.notes.end());
  for (std::size_t i = 0; i < raw.values.size(); ++i) conversions[i].apply(raw.values[i]);
  const std::vector<double> time_s = times_of(head, mapping, choice, raw, out.notes);
  std::vector<std::size_t> kept;
  leave_out_empty(mapping, raw.values, kept, out.notes);
  out.rows = RowTaker(file, mapping, choice).take(time_s, raw.values, kept);
  return out;
}

}  // namespace stillhand::measurement
