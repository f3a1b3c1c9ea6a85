// SPDX-License-Identifier: Apache-2.0
#include "apps/measurement/sample_screen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/measurement/sample_faults.hpp"
#include "services/contract/config_error.hpp"
#include "services/diagnosis/core/signals.hpp"

namespace stillhand::measurement {
namespace {

using diagnosis::SampleFault;
using recording::Column;
using recording::Recording;

constexpr std::size_t kMostTimes = 10;
constexpr std::size_t kLeastRows = 200;  // two seconds of 100 Hz: fewer show no habit of a channel

// What the faults of all columns do to the rows and to the columns.
struct Screened {
  std::vector<SampleFault> faults;
  std::vector<char> is_bad;  // rows to leave out
  std::vector<std::string> left_out;
};

double mean_step(const std::vector<double>& x, const Place& place) {
  double sum = 0.0;
  for (std::size_t i = place.first + 1; i < place.end; ++i) sum += std::abs(x[i] - x[i - 1]);
  return sum / static_cast<double>(place.rows() - 1);
}

class Screen {
 public:
  Screen(const Recording& rows, const ModelChannels& channels)
      : rows_(rows), channels_(channels), out_{{}, std::vector<char>(rows.row_count(), 0), {}} {
    for (const Column& column : rows.columns) {
      many_levels_.push_back(has_many_levels(column.values));
      usual_.push_back(many_levels_.back() ? usual_off_neighbours(column.values) : 0.0);
    }
  }

  Screened all() {
    for (std::size_t c = 0; c < rows_.columns.size(); ++c) {
      if (many_levels_[c]) look_at(rows_.columns[c]);
    }
    if (2 * static_cast<std::size_t>(std::ranges::count(out_.is_bad, 1)) > rows_.row_count()) {
      std::ranges::fill(out_.is_bad, 0);
      for (SampleFault& fault : out_.faults) fault.unsound = true;
    }
    return std::move(out_);
  }

 private:
  [[nodiscard]] bool is_input(const Column& column) const {
    return std::ranges::find(channels_.inputs, column.name) != channels_.inputs.end();
  }
  [[nodiscard]] bool of_model(const Column& column) const {
    return is_input(column) || column.name == channels_.output;
  }

  // No other channel jumps there: what really hits a rig shows in more than one.
  [[nodiscard]] bool is_quiet(const Column& column, const Place& place) const {
    constexpr double kJumps = 6.0;  // standard deviations
    for (std::size_t c = 0; c < rows_.columns.size(); ++c) {
      if (&rows_.columns[c] == &column || !(usual_[c] > 0.0)) continue;
      for (std::size_t i = place.first - 1; i <= place.end; ++i) {
        if (off_neighbours(rows_.columns[c].values, i) > kJumps * usual_[c]) return false;
      }
    }
    return true;
  }

  // Of the model: the input moves on (of an input, the output does), or has stopped at the same
  // row.  Another channel need not follow the input, but has a noise that does not stop.
  [[nodiscard]] bool should_move(const Column& column, const Place& place) const {
    constexpr double kMovesOn = 0.5;  // of its mean step
    constexpr double kNoise = 0.02;   // likewise: a command is smooth to 1e-4
    if (!of_model(column)) {
      const auto c = static_cast<std::size_t>(&column - rows_.columns.data());
      return usual_[c] >= kNoise * mean_step(column.values, {0, column.values.size()});
    }
    for (std::size_t c = 0; c < rows_.columns.size(); ++c) {
      const Column& other = rows_.columns[c];
      const bool asked = is_input(column) ? other.name == channels_.output : is_input(other);
      if (!asked || !many_levels_[c]) continue;
      const double step = mean_step(other.values, {place.first + 2, place.end});
      if (step == 0.0 || step >= kMovesOn * mean_step(other.values, {0, other.values.size()})) {
        return true;
      }
    }
    return false;
  }

  void look_at(const Column& column) {
    std::vector<double> mended;
    for (const BadRows& far : far_values(column.values)) {
      take_out(column, far);
      if (mended.empty()) mended = column.values;
      for (const Place& place : far.places) bridge(mended, place);
    }
    const std::vector<double>& values = mended.empty() ? column.values : mended;
    const std::vector<Place> runs = equal_runs(values);
    if (judge_whole(column, values, runs)) return;
    const auto spikes = spikes_in(values, rows_.rate_hz,
                                  [&](const Place& place) { return is_quiet(column, place); });
    if (spikes) take_out(column, *spikes);
    const auto stuck = stuck_in(values, runs, rows_.rate_hz,
                                [&](const Place& place) { return should_move(column, place); });
    if (stuck) take_out(column, *stuck);
    if (const auto clipped = clipped_in(values, runs)) {
      add(column, *clipped, "; they stay, as a limit of the channel.");
    }
  }

  static void bridge(std::vector<double>& values, const Place& place) {
    const double before = values[place.first > 0 ? place.first - 1 : place.end % values.size()];
    const double after = place.end < values.size() ? values[place.end] : before;
    for (std::size_t i = place.first; i < place.end; ++i) {
      values[i] = before + (after - before) * static_cast<double>(i + 1 - place.first) /
                               static_cast<double>(place.rows() + 1);
    }
  }

  SampleFault& add(const Column& column, const BadRows& bad, const std::string& what_follows) {
    SampleFault fault{column.name, bad.what, {}, 0.0, {}, false};
    for (const Place& place : bad.places) {
      if (fault.times_s.size() < kMostTimes) fault.times_s.push_back(rows_.time_s[place.first]);
    }
    fault.share = static_cast<double>(bad.rows()) / static_cast<double>(rows_.row_count());
    fault.says = fmt::format(
        "{}: {}{}, {:.3g} % of the rows in {} place{}, from {:.4g} s on{}", column.name, bad.what,
        bad.detail.empty() ? "" : " at " + bad.detail, 100.0 * fault.share, bad.places.size(),
        bad.places.size() == 1 ? "" : "s", fault.times_s.front(), what_follows);
    out_.faults.push_back(std::move(fault));
    return out_.faults.back();
  }

  void take_out(const Column& column, const BadRows& bad) {
    if (!of_model(column)) {
      out_.left_out.push_back(column.name);
      add(column, bad, "; the channel is left out.");
    } else if (2 * bad.rows() > rows_.row_count()) {
      add(column, bad, "; too many to leave them out.").unsound = true;
    } else {
      for (const Place& place : bad.places) {
        std::fill(out_.is_bad.begin() + static_cast<std::ptrdiff_t>(place.first),
                  out_.is_bad.begin() + static_cast<std::ptrdiff_t>(place.end), 1);
      }
      add(column, bad, "; these rows are left out.");
    }
  }

  // Every row alike: the channel carries nothing, or less than its rows say.
  bool judge_whole(const Column& column, const std::vector<double>& values,
                   const std::vector<Place>& runs) {
    SampleFault fault{column.name, {}, {rows_.time_s.front()}, 1.0, {}, of_model(column)};
    if (counts_rows(values)) {
      fault.what = "counter";
      fault.says = column.name + ": a counter, whose steps are all equal";
    } else if (const double held =
                   is_motion_or_force(column.unit) ? held_rows(values, runs, rows_.rate_hz) : 0.0;
               held > 0.0) {
      fault.what = "held";
      fault.says = fmt::format(
          "{}: each value is held for {:.3g} rows: {:.4g} Hz inside {:.4g} Hz, late by {:.3g} ms "
          "on the mean; record it at its own rate",
          column.name, held, rows_.rate_hz / held, rows_.rate_hz,
          500.0 * (held - 1.0) / rows_.rate_hz);
    } else {
      return false;
    }
    if (!fault.unsound) {
      out_.left_out.push_back(column.name);
      fault.says += "; the channel is left out";
    }
    fault.says += ".";
    out_.faults.push_back(std::move(fault));
    return true;
  }

  // A voltage may step, and a temperature is slow; what has a mass does neither.
  static bool is_motion_or_force(const std::string& unit) {
    return diagnosis::quantity_of(unit) != diagnosis::Quantity::kOther || unit == "N" ||
           unit == "N*m";
  }

  const Recording& rows_;
  const ModelChannels& channels_;
  Screened out_;
  std::vector<bool> many_levels_;
  std::vector<double> usual_;  // of off_neighbours(), each column
};

void leave_rows_out(Recording& rows, const std::vector<char>& is_bad) {
  if (std::ranges::count(is_bad, 1) == 0) return;
  const auto keep = [&](std::vector<double>& values) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (is_bad[i] == 0) values[kept++] = values[i];
    }
    values.resize(kept);
  };
  for (Column& column : rows.columns) keep(column.values);
  keep(rows.time_s);
  recording::estimate_timing(rows);
}

}  // namespace

std::vector<SampleFault> screen(Recording& rows, const ModelChannels& channels) {
  if (rows.row_count() < kLeastRows) return {};
  const Screened found = Screen(rows, channels).all();
  std::erase_if(rows.columns, [&](const Column& column) {
    return std::ranges::find(found.left_out, column.name) != found.left_out.end();
  });
  if (rows.columns.empty()) {
    throw ConfigError(rows.source, "no channel of measurements (" + found.faults.front().says + ")",
                      "one or more");
  }
  leave_rows_out(rows, found.is_bad);
  return found.faults;
}

}  // namespace stillhand::measurement
