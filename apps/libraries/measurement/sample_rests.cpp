// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/sample_rests.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/libraries/measurement/sample_faults.hpp"

namespace stillhand::measurement {
namespace {

std::size_t shortest_rest(double rate_hz) {
  constexpr std::size_t kLeastRows = 10;
  return std::max(static_cast<std::size_t>(kShortestStuck_s * rate_hz), kLeastRows);
}

// @param jitter  that a value of a rest may have
std::optional<BadRows> rests_in(const std::vector<double>& values, const std::vector<Place>& runs,
                                double jitter, std::size_t shortest,
                                const std::function<bool(const Place&)>& should_move) {
  constexpr std::size_t kLongerThanOthers = 10;
  constexpr double kJump = 4.0;     // of a usual step: 2.7 standard deviations of a slope
  constexpr double kSlowing = 0.2;  // of a usual step: what comes to rest is slower than that
  constexpr double kRough = 0.5;    // of the deviation: each row is a new value
  constexpr std::size_t kRowsBefore = 5;
  constexpr std::size_t kLong = 5;  // 1 s: ten periods of a hand's fastest
  constexpr std::size_t kLeastMoving =
      5;  // a fifth of the rows: what rests longer is known by that
  std::size_t longest = 0;
  std::size_t natural = 1;  // rows of the longest of the others
  std::size_t rows = 0;     // of the others
  for (const Place& run : runs) {
    longest = std::max(longest, run.rows());
    if (run.rows() >= shortest) continue;
    natural = std::max(natural, run.rows());
    rows += run.rows();
  }
  const std::size_t least = std::max(shortest, kLongerThanOthers * natural);
  if (longest < least || kLeastMoving * rows < values.size()) return {};
  const double usual = usual_step(values, runs);
  const bool rough = usual > kRough * deviation_of(values);
  const auto [low, high] = std::ranges::minmax(values);
  BadRows bad{"stuck", {}, {}};
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const Place& run = runs[r];
    const double value = values[run.first];
    if (run.rows() < least || run.first <= kRowsBefore || value - low <= jitter ||
        high - value <= jitter) {
      continue;
    }
    const bool ends = run.end < values.size();
    const bool jumps = step_to(values, run.first) >= kJump * usual ||
                       (ends && step_to(values, run.end) >= kJump * usual);
    const double slowing = middle_over_rows(run.first - kRowsBefore, run.first + 1,
                                            [&](std::size_t i) { return step_to(values, i); });
    const bool is_level = std::ranges::any_of(runs, [&](const Place& other) {
      return other.first != run.first && other.rows() >= kClippedRows &&
             std::abs(values[other.first] - value) <= jitter;
    });
    const bool is_new = rough || !ends || run.rows() >= kLong * shortest;
    if (slowing < kSlowing * usual || !(jumps || (is_new && !is_level))) continue;
    if (should_move(run)) bad.places.push_back(run);
  }
  if (bad.places.empty()) return {};
  bad.detail = fmt::format("{:.6g}", values[bad.places.front().first]);
  return bad;
}

// Values whose rests have one value each, though their last digit jitters.
struct Levelled {
  std::vector<double> values;
  double jitter = 0.0;  // of a rest, from its lowest to its highest value; 0: there are none
};

Levelled levelled(const std::vector<double>& values, std::size_t shortest) {
  constexpr double kDigits = 4.5;  // two up and two down of the last, and rounding
  constexpr double kFine = 0.1;    // of a usual step
  double digit = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double step = step_to(values, i);
    if (step > 0.0) digit = std::min(digit, step);
  }
  Levelled out{values, kDigits * digit};
  for (std::size_t first = 0, end = 0; first < values.size(); first = end) {
    double low = values[first];
    double high = low;
    for (end = first + 1; end < values.size(); ++end) {
      low = std::min(low, values[end]);
      high = std::max(high, values[end]);
      if (high - low > out.jitter) break;
    }
    if (end - first < shortest) {
      end = first + 1;
      continue;
    }
    std::fill(out.values.begin() + static_cast<std::ptrdiff_t>(first),
              out.values.begin() + static_cast<std::ptrdiff_t>(end), values[first]);
  }
  const std::vector<Place> runs = equal_runs(out.values);
  if (runs.size() < 2 || !(out.jitter <= kFine * usual_step(out.values, runs))) return {};
  return out;
}

}  // namespace

std::optional<BadRows> stuck_in(const std::vector<double>& values, double rate_hz,
                                const std::function<bool(const Place&)>& should_move) {
  const std::size_t shortest = shortest_rest(rate_hz);
  if (auto rests = rests_in(values, equal_runs(values), 0.0, shortest, should_move)) return rests;
  const Levelled level = levelled(values, shortest);
  if (level.values.empty()) return {};
  return rests_in(level.values, equal_runs(level.values), level.jitter, shortest, should_move);
}

}  // namespace stillhand::measurement
