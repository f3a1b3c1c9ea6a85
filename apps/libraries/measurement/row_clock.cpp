// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/row_clock.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "services/core/contract/config_error.hpp"

namespace stillhand::measurement {
namespace {

// Beyond this a resampled value is closer to the truth than the unchanged row, Eq. ME-2: at a tenth
// of the rate, 2 % of a period are 1.3 % of a sine's amplitude.
constexpr double kMostJitter_periods = 0.02;

// Largest decimal step of which every time is a multiple, or else the resolution of a double.
double resolution_s(const std::vector<double>& time_s) {
  const double largest_s = std::max(std::abs(time_s.front()), std::abs(time_s.back()));
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  for (int digits = 0; digits <= 9; ++digits) {
    const double scale = std::pow(10.0, digits);
    // Allows for the rounding of a decimal number to a double.  A double of 1e13 has no digits
    // left.
    if (largest_s * scale > 1e13) break;
    const bool multiple = std::ranges::all_of(time_s, [&](double t) {
      const double scaled = t * scale;
      return std::abs(scaled - std::round(scaled)) <= 2.0 * kEpsilon * std::abs(scaled);
    });
    if (multiple) return 1.0 / scale;
  }
  return 2.0 * kEpsilon * largest_s;
}

// Stamps as coarse as the period have steps of 1 and 2.  RC-1 and RC-2 interpret these as a shorter
// period with many gaps of one row.
RowCount best_count(const recording::Recording& rows, double resolution_s) {
  const double period_s = 1.0 / rows.rate_hz;
  constexpr double kCoarse_periods = 0.25;
  constexpr std::ptrdiff_t kFewGaps = 4;  // up to this number, they are real gaps
  RowCount plain = count_rows(rows.time_s, period_s);
  const auto singles = std::ranges::count(rows.gaps, 1, &recording::Gap::missing_rows);
  if (resolution_s < kCoarse_periods * period_s || singles <= kFewGaps) return plain;
  double sum_s = 0.0;
  double count = 0.0;
  for (std::size_t i = 1; i < rows.time_s.size(); ++i) {
    const double step_s = rows.time_s[i] - rows.time_s[i - 1];
    if (step_s > 2.5 * period_s) continue;
    sum_s += step_s;
    count += 1.0;
  }
  RowCount coarse = count_rows(rows.time_s, sum_s / count);
  // The coarse period must leave no such gap; otherwise it has only moved the gaps.
  const auto gap =
      std::ranges::adjacent_find(coarse.places, [](double a, double b) { return b - a == 2.0; });
  const bool explains =
      !coarse.lost && gap == coarse.places.end() && coarse.only_rounded(resolution_s);
  return explains ? coarse : plain;
}

// Rounds to a whole number of Hz, or of seconds, if the stamps cannot show the difference over the
// longest stretch, Eq. ME-1.
double tidy_rate_hz(double period_s, double resolution_s, const RowCount& count) {
  double longest = 1.0;
  for (const RowStretch& stretch : count.stretches) {
    longest = std::max(longest, count.places[stretch.end_row - 1]);
  }
  const double rate_hz = 1.0 / period_s;
  const double whole_hz = period_s > 1.0 ? 1.0 / std::round(period_s) : std::round(rate_hz);
  const double shift_periods = std::abs(whole_hz / rate_hz - 1.0) * longest;
  // Three standard errors of the slope through stamps rounded to the resolution.
  const double error_periods = 3.0 * resolution_s / period_s / std::sqrt(longest);
  return shift_periods <= std::max(kMostJitter_periods, error_periods) ? whole_hz : rate_hz;
}

}  // namespace

RowPlaces place_rows(const recording::Recording& rows) {
  const std::vector<double>& time_s = rows.time_s;
  const auto usable = [](double period) {
    return std::isnormal(period) && std::isfinite(1.0 / period);
  };
  if (!std::isfinite(time_s.back() - time_s.front()) || !usable(1.0 / rows.rate_hz)) {
    throw ConfigError(rows.source + ", time",
                      "stamps from " + std::to_string(time_s.front()) + " to " +
                          std::to_string(time_s.back()) + " s",
                      "times in seconds that give a sample rate");
  }
  const double resolution = resolution_s(time_s);
  RowCount count = best_count(rows, resolution);
  RowPlaces out;
  out.jitter_periods = count.median_periods;
  out.lost_between = count.lost_between;
  out.as_stamped = count.crowded || count.lost ||
                   (!count.only_rounded(resolution) && out.jitter_periods > kMostJitter_periods);
  const double period_s = out.as_stamped ? period_between_gaps(time_s, count) : count.period_s;
  out.rate_hz = tidy_rate_hz(period_s, resolution, count);
  out.places = std::move(count.places);
  out.stretches = std::move(count.stretches);
  for (RowStretch& stretch : out.stretches) {
    for (std::size_t i = stretch.first_row; out.as_stamped && i < stretch.end_row; ++i) {
      out.places[i] = (time_s[i] - stretch.start_s) * out.rate_hz;
    }
    const double last = out.places[stretch.end_row - 1];
    // 1e-9: rounding may have put the last row before its sample.
    stretch.grid_samples = static_cast<std::size_t>(last + 1e-9) + 1;
  }
  return out;
}

}  // namespace stillhand::measurement
