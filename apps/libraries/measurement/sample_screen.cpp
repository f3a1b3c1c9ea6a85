// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/sample_screen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "apps/libraries/measurement/sample_faults.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/model/signals.hpp"

namespace stillhand::measurement {
namespace {

using diagnosis::SampleFault;
using recording::Column;
using recording::Recording;

constexpr std::size_t kMostTimes = 10;
constexpr double kJumps = 6.0;           // standard deviations
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
      jumps_.push_back(of_model(column)
                           ? jumps_out_and_back(column.values, usual_.back(), rows.rate_hz)
                           : std::vector<Place>());
    }
  }

  Screened all() {
    for (std::size_t c = 0; c < rows_.columns.size(); ++c) {
      many_levels_[c] ? look_at(rows_.columns[c]) : look_at_few(rows_.columns[c]);
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
    const auto own = static_cast<std::size_t>(&column - rows_.columns.data());
    for (std::size_t c = 0; c < rows_.columns.size(); ++c) {
      if (c == own || !(usual_[c] > 0.0) || jumps_apart(own, c, place)) continue;
      for (std::size_t i = place.first - 1; i <= place.end; ++i) {
        if (off_neighbours(rows_.columns[c].values, i) > kJumps * usual_[c]) return false;
      }
    }
    return true;
  }

  // A motion and a force of the model that both jump out and back at once, and not as one jumps
  // with the other in all other rows: no body answers a blow for a row or two, and with a force
  // that its motion does not have otherwise.
  [[nodiscard]] bool jumps_apart(std::size_t one, std::size_t other, const Place& place) const {
    constexpr double kOfOther = 0.5;
    const Column& a = rows_.columns[one];
    const Column& b = rows_.columns[other];
    const auto meets = [&](const Place& each) {
      return each.first < place.end && place.first < each.end;
    };
    if (a.unit == b.unit || is_input(a) == is_input(b) ||
        std::ranges::none_of(jumps_[other], meets)) {
      return false;
    }
    const auto jump = [&](const std::vector<double>& x) {
      return x[place.first] - 0.5 * (x[place.first - 1] + x[place.end]);
    };
    const double of_b = jump(b.values);
    return std::abs(of_b - fast_gain(one, other) * jump(a.values)) > kOfOther * std::abs(of_b);
  }

  // How a row of one lies off its neighbours with a row of the other, where neither jumps.
  [[nodiscard]] double fast_gain(std::size_t one, std::size_t other) const {
    const auto [known, is_new] = gains_.try_emplace({one, other}, 0.0);
    if (!is_new) return known->second;
    double products = 0.0;
    double squares = 0.0;
    for (std::size_t i = 2; i + 2 < rows_.row_count(); ++i) {
      const double of_a = above_neighbours(rows_.columns[one].values, i);
      const double of_b = above_neighbours(rows_.columns[other].values, i);
      if (std::abs(of_a) > kJumps * usual_[one] || std::abs(of_b) > kJumps * usual_[other])
        continue;
      products += of_a * of_b;
      squares += of_a * of_a;
    }
    return known->second = squares > 0.0 ? products / squares : 0.0;
  }

  // Of the model: the input moves on (of an input, the output does), or has stopped at the same
  // row.  Another channel need not follow the input, but has a noise that does not stop.
  [[nodiscard]] bool should_move(const Column& column, const Place& place) const {
    constexpr double kMovesOn = 0.5;  // of its mean step
    constexpr double kNoise = 0.02;   // likewise: a command is smooth to 1e-4
    if (!of_model(column)) {
      const std::vector<double> before(
          column.values.begin(), column.values.begin() + static_cast<std::ptrdiff_t>(place.first));
      return before.size() >= kLeastRows &&
             usual_off_neighbours(before) >= kNoise * mean_step(before, {0, before.size()});
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
    const auto stuck = stuck_in(values, rows_.rate_hz,
                                [&](const Place& place) { return should_move(column, place); });
    if (stuck) take_out(column, *stuck);
    if (const auto dropped = dropped_in(values, rows_.rate_hz)) take_out(column, *dropped);
    if (const auto clipped = clipped_in(values, runs)) {
      // What a sensor of the input did not see, no effect can tell; a force may have a limit.
      const bool blind = is_input(column) && is_motion_or_force(column.unit) &&
                         static_cast<double>(clipped->rows()) >
                             diagnosis::kMostClipped * static_cast<double>(rows_.row_count());
      add(column, *clipped,
          blind ? "; what it did not see is unknown." : "; they stay, as a limit of the channel.")
          .unsound = blind;
    }
  }

  // A motion or a force of a few values: rounded, or behind a converter of few bits.
  void look_at_few(const Column& column) {
    if (!of_model(column) || !is_motion_or_force(column.unit)) return;
    const std::size_t levels = coarse_levels(column.values);
    if (levels == 0) return;
    add_whole(column, "coarse", fmt::format("{} values in all, too coarse for a model", levels));
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
    if (counts_rows(values)) {
      add_whole(column, "counter", "a counter, whose steps are all equal");
      return true;
    }
    if (const auto places = overflows(values); !places.empty()) {
      add_whole(column, "overflow",
                fmt::format("leaves its range at one end and goes on at the other, {} times",
                            places.size()));
      return true;
    }
    if (is_beyond_a_turn(column)) {
      add_whole(column, "unit", "beyond a turn in half of the rows: degrees, not rad?");
      return true;
    }
    if (!is_motion_or_force(column.unit)) return false;
    double rows = held_rows(values, runs, rows_.rate_hz);
    if (rows == 0.0) rows = comb_rows(values, 1, rows_.rate_hz);
    if (rows > 0.0) {
      add_whole(column, "held",
                fmt::format("each value is held for {}, late by {:.3g} ms on the mean; record it "
                            "at its own rate",
                            own_rate(rows), 500.0 * (rows - 1.0) / rows_.rate_hz));
    }
    return rows > 0.0 || held_unevenly(column, values) || in_lines(column, values);
  }

  bool held_unevenly(const Column& column, const std::vector<double>& values) {
    const double rows = uneven_rows(values, rows_.rate_hz);
    if (rows == 0.0) return false;
    add_whole(
        column, "held",
        fmt::format("values are held unevenly: about {:.2g} Hz inside {:.4g} Hz; record it at "
                    "its own rate",
                    rows_.rate_hz / rows, rows_.rate_hz));
    return true;
  }

  [[nodiscard]] std::string own_rate(double rows) const {
    return fmt::format("{:.3g} rows: {:.4g} Hz inside {:.4g} Hz", rows, rows_.rate_hz / rows,
                       rows_.rate_hz);
  }

  // Straight lines between samples of r Hz let sinc(f/r)^2 of f through.  A target may move so.
  bool in_lines(const Column& column, const std::vector<double>& values) {
    constexpr double kBand_hz = 4.0;  // of the paper's motion
    constexpr double kNoticed = 0.01;
    constexpr double kLeastChord =
        1e-6;  // a thousandth of the amplitude: a ramp's last digit bends
    if (column.unit != "m/s^2" && column.unit != "N" && column.unit != "N*m") return false;
    double rows = straight_rows(values, rows_.rate_hz);
    if (rows == 0.0) rows = comb_rows(values, 2, rows_.rate_hz);
    if (rows > 0.0 && chord_error(values, rows) < kLeastChord) return false;
    const double angle = std::numbers::pi * kBand_hz * rows / rows_.rate_hz;
    const double loss = rows > 0.0 ? 1.0 - std::pow(std::sin(angle) / angle, 2.0) : 0.0;
    if (loss < kNoticed) return false;
    const bool much = loss > diagnosis::kMostClipped;
    const std::string says = fmt::format(
        "straight lines of {}, which lose {:.2g} % at {:g} Hz; "
        "record it at its own rate",
        own_rate(rows), 100.0 * loss, kBand_hz);
    much ? add_whole(column, "held", says) : note_whole(column, "held", says + ".", false);
    return much;
  }

  // No stick and no cabin turns by as much.
  static bool is_beyond_a_turn(const Column& column) {
    if (column.unit != "rad" || (column.name != "theta" && column.name != "roll")) return false;
    const auto beyond = std::ranges::count_if(
        column.values, [](double angle) { return std::abs(angle) > 2.0 * std::numbers::pi; });
    return 2 * static_cast<std::size_t>(beyond) > column.values.size();
  }

  void add_whole(const Column& column, const std::string& what, const std::string& says) {
    const bool unsound = of_model(column);
    if (!unsound) out_.left_out.push_back(column.name);
    note_whole(column, what, says + (unsound ? "." : "; the channel is left out."), unsound);
  }

  void note_whole(const Column& column, const std::string& what, const std::string& says,
                  bool unsound) {
    out_.faults.push_back(
        {column.name, what, {rows_.time_s.front()}, 1.0, column.name + ": " + says, unsound});
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
  mutable std::map<std::pair<std::size_t, std::size_t>, double> gains_;  // fast_gain(), when asked
  std::vector<std::vector<Place>> jumps_;  // out and back, each column of the model
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
