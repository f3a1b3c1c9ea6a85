// SPDX-License-Identifier: Apache-2.0
#include "apps/measurement/sample_faults.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace stillhand::measurement {
namespace {

// A channel of fewer levels is a state or a switch, whose values no range describes.
constexpr std::size_t kFewLevels = 16;
constexpr double kClippedRows = 3.0;  // fewer can be equal by chance at the top of a swing

double middle_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

std::vector<double> sorted_good(const std::vector<double>& values,
                                const std::vector<char>& is_bad) {
  std::vector<double> out;
  out.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (is_bad[i] == 0) out.push_back(values[i]);
  }
  std::ranges::sort(out);
  return out;
}

bool has_few_levels(const std::vector<double>& sorted) {
  std::size_t levels = 1;
  for (std::size_t i = 1; i < sorted.size() && levels <= kFewLevels; ++i) {
    if (sorted[i] != sorted[i - 1]) ++levels;
  }
  return levels <= kFewLevels;
}

// The end of a converter's or a counter's range: a power of two, or one less.
bool is_rail(double value) {
  const auto power = [](double size) {
    return size >= 127.0 && std::exp2(std::round(std::log2(size))) == size;
  };
  return power(std::abs(value)) || power(std::abs(value) + 1.0);
}

void mark(BadRows& bad, std::size_t first, std::size_t end, std::vector<char>& is_bad) {
  if (!bad.places.empty() && bad.places.back().end == first) {
    bad.places.back().end = end;
  } else {
    bad.places.push_back({first, end});
  }
  std::fill(is_bad.begin() + static_cast<std::ptrdiff_t>(first),
            is_bad.begin() + static_cast<std::ptrdiff_t>(end), 1);
}

// Of values in order, the one at an end, farther from all others than they are from each other.
std::optional<double> far_value(const std::vector<double>& sorted) {
  const double low = sorted.front();
  const double high = sorted.back();
  const auto above_low = std::ranges::upper_bound(sorted, low);
  if (above_low == sorted.end()) return {};
  const auto high_begin = std::ranges::lower_bound(sorted, high);
  const auto lows = above_low - sorted.begin();
  const auto highs = sorted.end() - high_begin;
  const double below_high = *(high_begin - 1);
  const auto most = static_cast<std::ptrdiff_t>(sorted.size() / 2);
  if (highs >= 2 && highs <= most && high - below_high > below_high - low) return high;
  if (lows >= 2 && lows <= most && *above_low - low > high - *above_low) return low;
  return {};
}

}  // namespace

std::vector<EqualRun> equal_runs(const std::vector<double>& values) {
  std::vector<EqualRun> out{{0, 1}};
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] == values[i - 1]) {
      ++out.back().end;
    } else {
      out.push_back({i, i + 1});
    }
  }
  return out;
}

std::size_t BadRows::rows() const noexcept {
  std::size_t sum = 0;
  for (const EqualRun& place : places) sum += place.rows();
  return sum;
}

std::vector<BadRows> far_values(const std::vector<double>& values, std::vector<char>& is_bad) {
  // A file has one fill value and a rail at either end; a few more do no harm.
  constexpr std::size_t kMostValues = 8;
  std::vector<BadRows> out;
  std::vector<double> sorted = sorted_good(values, is_bad);
  while (out.size() < kMostValues && sorted.size() > 1) {
    const std::optional<double> far = far_value(sorted);
    if (!far) break;
    std::erase(sorted, *far);
    BadRows bad{is_rail(*far) ? "rail" : "sentinel", {}, fmt::format("{:.9g}", *far)};
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (values[i] == *far) mark(bad, i, i + 1, is_bad);
    }
    out.push_back(std::move(bad));
  }
  if (has_few_levels(sorted)) {
    std::ranges::fill(is_bad, 0);
    return {};
  }
  return out;
}

std::optional<BadRows> spikes_in(const std::vector<double>& values, std::vector<char>& is_bad) {
  const std::vector<double> sorted = sorted_good(values, is_bad);
  if (sorted.size() < 100 || has_few_levels(sorted)) return {};
  const double span = sorted[sorted.size() * 99 / 100] - sorted[sorted.size() / 100];
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) {
    steps.push_back(std::abs(values[i] - values[i - 1]));
  }
  // 25 standard deviations of white noise, whose steps have a median of 0.95 of one.
  const double least = std::max(span, 25.0 / 0.95 * middle_of(std::move(steps)));
  constexpr std::size_t kWidest = 3;
  BadRows bad{"spikes", {}, {}};
  for (std::size_t i = 1; i + 1 < values.size(); ++i) {
    const double up = values[i] - values[i - 1];
    if (std::abs(up) < least || is_bad[i] != 0 || is_bad[i - 1] != 0) continue;
    for (std::size_t end = i + 1; end < std::min(i + 1 + kWidest, values.size()); ++end) {
      const double down = values[end] - values[end - 1];
      if (is_bad[end] != 0 || std::abs(down) < least || down * up > 0.0) continue;
      mark(bad, i, end, is_bad);
      i = end;
      break;
    }
  }
  if (bad.places.empty()) return {};
  return bad;
}

std::optional<BadRows> stuck_in(const std::vector<double>& values,
                                const std::vector<EqualRun>& runs, double rate_hz, bool rests,
                                std::vector<char>& is_bad) {
  constexpr double kLeast_s = 0.2;   // a hand moves at 0.1 to 10 Hz: two periods of its fastest
  constexpr double kLeastRuns = 20;  // of the mean run: exp(-20) of a noise's last digit
  constexpr double kLeastRows = 10;
  const double shortest = std::max(kLeast_s * rate_hz, kLeastRows);
  double rows = 0.0;
  double count = 0.0;
  std::vector<double> steps;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    if (r > 0) steps.push_back(std::abs(values[runs[r].first] - values[runs[r - 1].first]));
    if (static_cast<double>(runs[r].rows()) >= shortest) continue;
    rows += static_cast<double>(runs[r].rows());
    count += 1.0;
  }
  if (count < 50.0 || rows < 0.5 * static_cast<double>(shortest)) return {};
  const double least = std::max(shortest, kLeastRuns * rows / count);
  const double usual = middle_of(steps);
  const auto [low, high] = std::ranges::minmax(values);
  // Held at another time too: a level of a command, or the limit of a channel that is clipped.
  const auto recurs = [&](double value, double rows_at_least) {
    return std::ranges::count_if(runs, [&](const EqualRun& run) {
             return static_cast<double>(run.rows()) >= rows_at_least && values[run.first] == value;
           }) > 1;
  };
  const auto is_level = [&](double value) {
    const bool is_end = value == low || value == high;
    return rests ? is_end || recurs(value, least) : is_end && recurs(value, kClippedRows);
  };
  BadRows bad{"stuck", {}, {}};
  for (std::size_t r = 1; r < runs.size(); ++r) {  // what rests at the start has not moved yet
    if (static_cast<double>(runs[r].rows()) < least || is_bad[runs[r].first] != 0) continue;
    const double value = values[runs[r].first];
    // A rest is reached smoothly, and a slow signal of few digits moves by one of them.
    const double jump = std::max(steps[r - 1], r < steps.size() ? steps[r] : 0.0);
    if (jump < 0.1 * usual || is_level(value)) continue;
    mark(bad, runs[r].first, runs[r].end, is_bad);
    if (bad.detail.empty()) bad.detail = fmt::format("{:.6g}", value);
  }
  if (bad.places.empty()) return {};
  return bad;
}

std::optional<BadRows> clipped_in(const std::vector<double>& values,
                                  const std::vector<EqualRun>& runs,
                                  const std::vector<char>& is_bad) {
  const std::vector<double> sorted = sorted_good(values, is_bad);
  if (sorted.size() < 100 || has_few_levels(sorted)) return {};
  // A sine of few digits has 1.3 times as many samples at its top level as at the next.
  constexpr std::ptrdiff_t kMoreThanNext = 4;
  const auto count = [&](double value) {
    const auto equal = std::ranges::equal_range(sorted, value);
    return std::ranges::ssize(equal);
  };
  BadRows bad{"clipped", {}, {}};
  for (const bool top : {false, true}) {
    const double end = top ? sorted.back() : sorted.front();
    const double next =
        top ? *(std::ranges::lower_bound(sorted, end) - 1) : *std::ranges::upper_bound(sorted, end);
    if (count(end) < kMoreThanNext * std::max<std::ptrdiff_t>(count(next), 2)) continue;
    std::vector<EqualRun> at_end;
    for (const EqualRun& run : runs) {
      if (values[run.first] == end && static_cast<double>(run.rows()) >= kClippedRows)
        at_end.push_back(run);
    }
    if (at_end.size() < 2) continue;
    bad.places.insert(bad.places.end(), at_end.begin(), at_end.end());
    bad.detail += fmt::format("{}{:.6g}", bad.detail.empty() ? "" : " and ", end);
  }
  if (bad.places.empty()) return {};
  std::ranges::sort(bad.places, {}, &EqualRun::first);
  return bad;
}

double held_rows(const std::vector<double>& values, const std::vector<EqualRun>& runs) {
  constexpr std::size_t kLeastRuns = 50;
  if (runs.size() < kLeastRuns || values.size() < 3 * runs.size() / 2) return 0.0;
  const double mean = static_cast<double>(values.size()) / static_cast<double>(runs.size());
  // Runs of a noise's last digit are geometric: of a mean of two rows, 87 % have one to three.
  constexpr double kLeastEven = 0.95;
  std::size_t even = 0;
  double squares = 0.0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    if (std::abs(static_cast<double>(runs[r].rows()) - mean) <= 1.0) ++even;
    if (r == 0) continue;
    const double step = values[runs[r].first] - values[runs[r - 1].first];
    squares += step * step / static_cast<double>(runs.size());
  }
  if (static_cast<double>(even) < kLeastEven * static_cast<double>(runs.size())) return 0.0;
  double average = 0.0;
  for (const double value : values) average += value / static_cast<double>(values.size());
  double variance = 0.0;
  for (const double value : values) {
    variance += (value - average) * (value - average) / static_cast<double>(values.size());
  }
  // Eq. ME-9: what holding costs, a third of a step's square, as a lag of 0.1 rad does.
  constexpr double kLeastError = 0.01;
  return squares / 3.0 >= kLeastError * variance ? mean : 0.0;
}

// A ramp of another kind is a signal: a counter has whole numbers, or begins again.
bool counts_rows(const std::vector<double>& values) {
  constexpr double kCounting = 0.98;  // a byte begins again every 256 rows; lost rows are rarer
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) steps.push_back(values[i] - values[i - 1]);
  const double usual = middle_of(steps);
  if (usual == 0.0) return false;
  const auto same = std::ranges::count_if(
      steps, [&](double step) { return std::abs(step - usual) <= 1e-3 * std::abs(usual); });
  const bool wraps = std::ranges::any_of(steps, [&](double step) { return step * usual < 0.0; });
  const bool whole = usual == std::round(usual) && values.front() == std::round(values.front());
  return (wraps || whole) &&
         static_cast<double>(same) >= kCounting * static_cast<double>(steps.size());
}

}  // namespace stillhand::measurement
