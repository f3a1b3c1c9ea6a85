// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/row_count.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/signal/moments.hpp"

namespace stillhand::measurement {
namespace {

constexpr double kBridged_s = 0.05;
constexpr std::int64_t kLeastBridge_rows = 3;
constexpr std::int64_t kMostBridge_rows = 1000;

// Follows the clock's phase through the rows, counts the periods between them, Eq. ME-1, and cuts
// at the long gaps.
void count_places(const std::vector<double>& time_s, double period_s, RowCount& out) {
  constexpr double kGain = 0.01;
  const auto longest = static_cast<double>(longest_bridge(1.0 / period_s));
  out.places.assign(time_s.size(), 0.0);
  out.stretches = {{0, 0, time_s[0], 0}};
  double place = 0.0, offset = 0.0, rows = 1.0;
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    const double elapsed = (time_s[i] - out.stretches.back().start_s) / period_s;
    double step = std::round(elapsed - offset - place);
    if (step < 1.0) {  // counts as 0, so that a late row does not move all following rows
      out.crowded = true;
      step = 0.0;
    }
    if (step > longest + 1.0) {
      out.stretches.back().end_row = i;
      out.stretches.push_back({i, 0, time_s[i], 0});
      out.lost_between += step - 1.0;
      place = offset = 0.0;
      rows = 1.0;
      continue;
    }
    place += step;
    rows += 1.0;
    // Follows a slowly drifting clock, but not a single late row.
    offset += std::max(kGain, 1.0 / rows) * (elapsed - place - offset);
    out.places[i] = place;
  }
  out.stretches.back().end_row = time_s.size();
}

// Products and squares of one least-squares line through [first, end), added to the others.
struct Slope {
  double products = 0.0;
  double squares = 0.0;

  void add(const std::vector<double>& time_s, const std::vector<double>& places, double period_s,
           std::size_t first, std::size_t end) {
    double mean_place = 0.0;
    double mean_late = 0.0;
    double rows = 0.0;
    for (std::size_t i = first; i < end; ++i) {
      const double late = (time_s[i] - time_s[first]) / period_s - (places[i] - places[first]);
      rows += 1.0;
      const double from_mean = places[i] - mean_place;
      mean_place += from_mean / rows;
      mean_late += (late - mean_late) / rows;
      products += from_mean * (late - mean_late);
      squares += from_mean * (places[i] - mean_place);
    }
  }
  [[nodiscard]] double period(double before_s) const {
    return squares > 0.0 ? before_s * (1.0 + products / squares) : before_s;
  }
};

// Eq. ME-1: one period for all stretches, a phase for each; a short gap is a whole number of
// periods.
double refined(const std::vector<double>& time_s, const RowCount& counted, double period_s) {
  Slope slope;
  for (const RowStretch& stretch : counted.stretches) {
    slope.add(time_s, counted.places, period_s, stretch.first_row, stretch.end_row);
  }
  return slope.period(period_s);
}

void judge(const std::vector<double>& time_s, RowCount& out) {
  // A median of some hundred thousand rows is accurate enough.
  const std::size_t stride = time_s.size() / 300'000 + 1;
  std::vector<double> distances;
  for (const RowStretch& stretch : out.stretches) {
    const auto late = [&](std::size_t i) {
      return (time_s[i] - stretch.start_s) / out.period_s - out.places[i];
    };
    double low = 0.0;
    double high = 0.0;
    double sum = 0.0;
    for (std::size_t i = stretch.first_row; i < stretch.end_row; ++i) {
      low = std::min(low, late(i));
      high = std::max(high, late(i));
      sum += late(i);
    }
    const double mean = sum / static_cast<double>(stretch.end_row - stretch.first_row);
    out.range_periods = std::max(out.range_periods, high - low);
    for (std::size_t i = stretch.first_row; i < stretch.end_row; i += stride) {
      distances.push_back(std::abs(late(i) - mean));
    }
  }
  out.median_periods = signal::middle_of(distances);
}

bool agree(double period_s, double other_s) { return std::abs(period_s / other_s - 1.0) < 0.01; }

}  // namespace

std::int64_t longest_bridge(double rate_hz) noexcept {
  const double rows = std::min(kBridged_s * rate_hz, static_cast<double>(kMostBridge_rows));
  // 0.01: 0.05 s at 100 Hz are five rows, even if the stamps give 99.99 Hz.
  return std::max(kLeastBridge_rows, static_cast<std::int64_t>(rows + 0.01));
}

RowCount count_rows(const std::vector<double>& time_s, double period_s) {
  RowCount out;
  count_places(time_s, period_s, out);
  out.period_s = refined(time_s, out, period_s);
  out.lost = !agree(out.period_s, period_s);
  if (out.lost) out.period_s = period_s;
  judge(time_s, out);
  return out;
}

double period_between_gaps(const std::vector<double>& time_s, const RowCount& count) {
  Slope slope;
  for (const RowStretch& stretch : count.stretches) {
    std::size_t first = stretch.first_row;
    for (std::size_t i = first + 1; i <= stretch.end_row; ++i) {
      if (i < stretch.end_row && count.places[i] - count.places[i - 1] < 1.5) continue;
      slope.add(time_s, count.places, count.period_s, first, i);
      first = i;
    }
  }
  const double period_s = slope.period(count.period_s);
  return agree(period_s, count.period_s) ? period_s : count.period_s;
}

}  // namespace stillhand::measurement
