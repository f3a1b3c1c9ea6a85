// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/sample_faults.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/libraries/measurement/sample_rests.hpp"
#include "services/core/signal/moments.hpp"

namespace stillhand::measurement {
namespace {

constexpr double kNormal = 1.4826;  // standard deviation of a normal one over its median size
// A hand moves at 0.1 to 10 Hz.  A pulse of it lasts half of a period at 25 Hz or longer.
constexpr double kShortestPulse_s = 0.02;

// The end of a converter's or a counter's range: a power of two, or one less.
bool is_rail(double value) {
  const auto power = [](double size) {
    return size >= 127.0 && std::exp2(std::round(std::log2(size))) == size;
  };
  return power(std::abs(value)) || power(std::abs(value) + 1.0);
}

// The lowest and the highest value, how often each comes, and the values next to them.
struct Ends {
  double low, above_low, below_high, high;
  std::size_t lows = 0, highs = 0;
};

Ends ends_of(const std::vector<double>& values) {
  const auto [low, high] = std::ranges::minmax(values);
  Ends out{low, high, low, high};
  for (const double value : values) {
    if (value == low) {
      ++out.lows;
    } else {
      out.above_low = std::min(out.above_low, value);
    }
    if (value == high) {
      ++out.highs;
    } else {
      out.below_high = std::max(out.below_high, value);
    }
  }
  return out;
}

// Where x is at a row, by the cubic through the two rows before it and two that lie h rows after it
// and one more.
double over_gap(double second, double first, double over, double beyond, double h) {
  // Lagrange at 0, nodes at -2, -1, h and h + 1.
  return -second * h * (h + 1.0) / ((h + 2.0) * (h + 3.0)) + 2.0 * first * h / (h + 2.0) +
         2.0 * over / (h + 2.0) - 2.0 * beyond * h / ((h + 3.0) * (h + 2.0));
}

// To the last place, or as a new one behind it.
void add_row(std::vector<Place>& places, std::size_t row) {
  if (places.empty() || places.back().end != row) places.push_back({row, row});
  places.back().end = row + 1;
}

// Of all rows but the places, the range of 99.5 %: a few spikes next to each other are no places.
std::pair<double, double> range_without(const std::vector<double>& values,
                                        const std::vector<Place>& places) {
  constexpr std::size_t kTail = 400;  // a 400th of the rows at either end
  std::vector<double> x;
  auto place = places.begin();
  for (std::size_t i = 0; i < values.size(); ++i) {
    while (place != places.end() && place->end <= i) ++place;
    if (place == places.end() || i < place->first) x.push_back(values[i]);
  }
  const auto tail = static_cast<std::ptrdiff_t>(x.size() / kTail);
  std::ranges::nth_element(x, x.begin() + tail);
  const double low = x[static_cast<std::size_t>(tail)];
  std::ranges::nth_element(x, x.end() - 1 - tail);
  return {low, *(x.end() - 1 - tail)};
}

}  // namespace

double step_to(const std::vector<double>& values, std::size_t row) {
  return std::abs(values[row] - values[row - 1]);
}

double usual_step(const std::vector<double>& values, const std::vector<Place>& runs) {
  return middle_over_rows(1, runs.size(),
                          [&](std::size_t r) { return step_to(values, runs[r].first); });
}

double deviation_of(const std::vector<double>& values) {
  return std::sqrt(signal::variance(values));
}

bool beat(const std::vector<Place>& places) {
  constexpr std::size_t kFewest = 5;
  if (places.size() < kFewest) return false;
  std::size_t least = places.back().first;
  std::size_t most = 0;
  for (std::size_t i = 1; i < places.size(); ++i) {
    const std::size_t rows = places[i].first - places[i - 1].first;
    least = std::min(least, rows);
    most = std::max(most, rows);
  }
  return 2 * least >= most;
}

std::size_t BadRows::rows() const noexcept {
  std::size_t sum = 0;
  for (const Place& place : places) sum += place.rows();
  return sum;
}

std::vector<Place> equal_runs(const std::vector<double>& values) {
  std::size_t equal = 0;
  std::size_t three = 0;
  for (std::size_t i = 2; i < values.size(); ++i) {
    const bool same = values[i] == values[i - 1];
    equal += same ? 1u : 0u;
    three += same && values[i - 1] == values[i - 2] ? 1u : 0u;
  }
  if (three == 0 && 4 * equal < values.size()) return {};
  std::vector<Place> out;
  std::size_t first = 0;
  for (std::size_t i = 1; i <= values.size(); ++i) {
    if (i < values.size() && values[i] == values[first]) continue;
    out.push_back({first, i});
    first = i;
  }
  return out;
}

bool has_many_levels(const std::vector<double>& values) {
  constexpr std::size_t kFewLevels = 16;
  std::vector<double> levels;
  for (const double value : values) {
    if (std::ranges::find(levels, value) != levels.end()) continue;
    levels.push_back(value);
    if (levels.size() > kFewLevels) return true;
  }
  return false;
}

std::vector<BadRows> far_values(const std::vector<double>& values) {
  // A file has one fill value and a rail at either end; a few more do no harm.
  constexpr std::size_t kMostFar = 8;
  std::vector<BadRows> out;
  std::vector<double> left = values;
  while (out.size() < kMostFar) {
    const Ends ends = ends_of(left);
    const double inner = ends.below_high - ends.above_low;
    const std::size_t most = values.size() / 2;
    const bool of_high =
        ends.highs >= 2 && ends.highs <= most && ends.high - ends.below_high > inner;
    const bool of_low = ends.lows >= 2 && ends.lows <= most && ends.above_low - ends.low > inner;
    if (!of_high && !of_low) break;
    const double far = of_high ? ends.high : ends.low;
    BadRows bad{is_rail(far) ? "rail" : "sentinel", {}, fmt::format("{:.9g}", far)};
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (values[i] == far) add_row(bad.places, i);
    }
    std::erase(left, far);
    out.push_back(std::move(bad));
  }
  return has_many_levels(left) ? out : std::vector<BadRows>();
}

double above_neighbours(const std::vector<double>& x, std::size_t i) {
  return x[i] - (4.0 * (x[i - 1] + x[i + 1]) - x[i - 2] - x[i + 2]) / 6.0;
}

double off_neighbours(const std::vector<double>& values, std::size_t row) {
  return std::abs(above_neighbours(values, row));
}

double usual_off_neighbours(const std::vector<double>& values) {
  return kNormal * middle_over_rows(2, values.size() - 2,
                                    [&](std::size_t i) { return off_neighbours(values, i); });
}

std::vector<Place> jumps_out_and_back(const std::vector<double>& x, double usual, double rate_hz) {
  constexpr double kLeast = 25.0;  // standard deviations; exp(-25) of Laplace's distribution
  constexpr double kGoesOn = 8.0;  // likewise; the cubic's own error is below two of them
  constexpr double kShakes = 0.1;  // of the jump: what was really hit moves on by more
  const double least = kLeast * usual;
  const auto most_rows =
      std::min<std::size_t>(2, static_cast<std::size_t>(kShortestPulse_s * rate_hz * (1.0 + 1e-6)));
  std::vector<Place> out;
  if (!(usual > 0.0)) return out;
  for (std::size_t i = 3; i + 4 < x.size(); ++i) {
    if (step_to(x, i) < least) continue;
    for (std::size_t rows = 1; rows <= most_rows; ++rows) {
      const std::size_t end = i + rows;
      const double line = 0.5 * (x[i - 1] + x[end]);
      const auto [jump, other] = std::minmax({std::abs(x[i] - line), std::abs(x[end - 1] - line)});
      if (jump < kShakes * other) continue;  // the second row alone
      const auto h = static_cast<double>(rows + 1);
      const double before = x[i - 1] - over_gap(x[i - 3], x[i - 2], x[end], x[end + 1], h);
      const double after = x[end] - over_gap(x[end + 2], x[end + 1], x[i - 1], x[i - 2], h);
      const double most = std::max(kGoesOn * usual, kShakes * jump);
      if (jump < least || std::abs(before) > most || std::abs(after) > most) continue;
      out.push_back({i, end});
      i = end;
      break;
    }
  }
  return out;
}

std::optional<BadRows> spikes_in(const std::vector<double>& values, double rate_hz,
                                 const std::function<bool(const Place&)>& quiet) {
  constexpr std::size_t kMostShare = 20;  // a twentieth of the rows: more are a signal
  std::vector<Place> places = jumps_out_and_back(values, usual_off_neighbours(values), rate_hz);
  if (places.empty()) return {};
  const auto [low, high] = range_without(values, places);
  const double range = high - low;
  std::erase_if(places, [&](const Place& place) {
    const double line = 0.5 * (values[place.first - 1] + values[place.end]);
    return std::abs(values[place.first] - line) <= range;
  });
  const auto of_one = static_cast<std::size_t>(std::ranges::count_if(places, quiet));
  if (beat(places) || 4 * of_one <= 3 * places.size()) return {};
  // Those next to each other are such too.
  BadRows bad{"spikes", {}, {}};
  auto place = places.begin();
  for (std::size_t i = 0; i < values.size(); ++i) {
    while (place != places.end() && place->end <= i) ++place;
    const bool inside = place != places.end() && i >= place->first;
    const bool beyond = values[i] > high + range || values[i] < low - range;
    if (inside || beyond) add_row(bad.places, i);
  }
  if (bad.rows() * kMostShare > values.size()) return {};
  return bad;
}

std::optional<BadRows> clipped_in(const std::vector<double>& values,
                                  const std::vector<Place>& runs) {
  constexpr std::size_t kFewestRuns = 3;
  constexpr std::size_t kOtherLength = 3;  // the plateaus of a trapezoid are equal within a row
  // A sine of few digits has 1.3 times as many samples at its top level as at the next.
  constexpr std::ptrdiff_t kMoreThanNext = 4;
  if (runs.empty()) return {};
  const Ends ends = ends_of(values);
  BadRows bad{"clipped", {}, {}};
  for (const bool top : {false, true}) {
    const double end = top ? ends.high : ends.low;
    const double next = top ? ends.below_high : ends.above_low;
    const auto count = static_cast<std::ptrdiff_t>(top ? ends.highs : ends.lows);
    if (end == 0.0) continue;  // what has one sign only rests at 0
    if (count < kMoreThanNext * std::ranges::count(values, next)) continue;
    std::vector<Place> at_end;
    std::size_t least = values.size();
    std::size_t most = 0;
    for (const Place& run : runs) {
      if (values[run.first] != end || run.rows() < kClippedRows) continue;
      at_end.push_back(run);
      if (run.first == 0 || run.end == values.size()) continue;
      least = std::min(least, run.rows());
      most = std::max(most, run.rows());
    }
    if (at_end.size() < kFewestRuns || most < least + kOtherLength) continue;
    bad.places.insert(bad.places.end(), at_end.begin(), at_end.end());
    bad.detail += fmt::format("{}{:.6g}", bad.detail.empty() ? "" : " and ", end);
  }
  if (bad.places.empty()) return {};
  std::ranges::sort(bad.places, {}, &Place::first);
  return bad;
}

std::optional<BadRows> dropped_in(const std::vector<double>& values, double rate_hz) {
  constexpr double kJump = 6.0;  // standard deviations of the bend at a row
  constexpr std::size_t kFewest = 5;
  const auto off_line = [&](std::size_t first, std::size_t end) {
    return std::abs(values[first] - 0.5 * (values[first - 1] + values[end]));
  };
  const double least = kJump * kNormal * middle_over_rows(1, values.size() - 1, [&](std::size_t i) {
                         return off_line(i, i + 1);
                       });
  if (!(least > 0.0)) return {};
  const auto longest = static_cast<std::size_t>(kShortestStuck_s * rate_hz);
  std::vector<Place> jumps;
  BadRows bad{"drop-outs", {}, "0"};
  for (std::size_t i = 0, end = 1; i < values.size(); i = end, ++end) {
    if (values[i] != 0.0) continue;
    while (end < values.size() && values[end] == 0.0) ++end;
    bad.places.push_back({i, end});
    const bool inside = i > 0 && end < values.size() && end - i <= longest;
    if (inside && off_line(i, end) >= least) jumps.push_back({i, end});
  }
  // What comes to 0 slowly rests there, and a limit is no drop-out.
  const auto [low, high] = std::ranges::minmax(values);
  if (jumps.size() < kFewest || beat(jumps) || 2 * jumps.size() < bad.places.size() ||
      !(low < 0.0 && high > 0.0)) {
    return {};
  }
  return bad;
}

}  // namespace stillhand::measurement
