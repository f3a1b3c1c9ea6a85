// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numeric>

#include "apps/libraries/measurement/sample_faults.hpp"

namespace stillhand::measurement {
namespace {

constexpr std::size_t kFewestRuns = 50;
constexpr double kLongest_s = 0.5;  // what is slower is a command's step, which is seen as one

}  // namespace

double held_rows(const std::vector<double>& values, const std::vector<Place>& runs,
                 double rate_hz) {
  // Runs of a noise's last digit are geometric: of a mean of two rows, 87 % have one to three, and
  // half have one.
  constexpr double kLeastEven = 0.95;
  constexpr double kLeastSteps = 3.0;  // of the smallest: single ones are those of a resolution
  constexpr double kLeastError = 0.01;
  if (runs.size() < kFewestRuns) return 0.0;
  const double mean = static_cast<double>(values.size()) / static_cast<double>(runs.size());
  if (mean > kLongest_s * rate_hz) return 0.0;
  std::size_t even = 0;
  std::size_t repeated = 0;
  double squares = 0.0;
  double smallest = 0.0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    if (std::abs(static_cast<double>(runs[r].rows()) - mean) <= 1.0) ++even;
    if (runs[r].rows() > 1) ++repeated;
    if (r == 0) continue;
    const double step = step_to(values, runs[r].first);
    smallest = r == 1 ? step : std::min(smallest, step);
    squares += step * step / static_cast<double>(runs.size());
  }
  const double enough = kLeastEven * static_cast<double>(runs.size());
  const bool at_own_rate = static_cast<double>(even) >= enough && 2 * repeated >= runs.size();
  if ((!at_own_rate && static_cast<double>(repeated) < enough) ||
      usual_step(values, runs) < kLeastSteps * smallest) {
    return 0.0;
  }
  const double deviation = deviation_of(values);
  return squares / 3.0 >= kLeastError * deviation * deviation ? mean : 0.0;
}

double straight_rows(const std::vector<double>& x, double rate_hz) {
  constexpr double kStraight = 0.005;  // of a large bend; 0.4 % of the rows of a noise
  constexpr double kLeastEven = 0.9;
  const auto bend = [&](std::size_t i) { return std::abs(x[i + 1] - 2.0 * x[i] + x[i - 1]); };
  std::vector<double> bends;
  for (std::size_t i = 1; i + 1 < x.size(); ++i) bends.push_back(bend(i));
  const auto large = bends.end() - 1 - std::ssize(bends) / 33;
  std::ranges::nth_element(bends, large);
  const double most = *large;
  std::vector<double> slopes;
  std::vector<std::size_t> lengths;
  bool inside = false;
  for (std::size_t i = 1; i + 1 < x.size(); ++i) {
    const double slope = x[i + 1] - x[i];
    const bool goes_on = bend(i) <= kStraight * most && slope != 0.0;
    if (goes_on && !inside) {
      slopes.push_back(slope);
      lengths.push_back(1);  // the chord has a row more than it has bends
    }
    if (goes_on) ++lengths.back();
    inside = goes_on;
  }
  const std::size_t lines = slopes.size();
  const auto sum = static_cast<double>(std::reduce(lengths.begin(), lengths.end()));
  if (lines < kFewestRuns ||
      3.0 * (sum - static_cast<double>(lines)) < static_cast<double>(x.size())) {
    return 0.0;
  }
  const double rows = sum / static_cast<double>(lines);
  const auto even = std::ranges::count_if(lengths, [&](std::size_t length) {
    return std::abs(static_cast<double>(length) - rows) <= 1.0;
  });
  // The slopes of a coarse resolution are few.
  std::ranges::sort(slopes);
  const auto alike = [&](double a, double b) { return std::abs(a - b) <= 1e-3 * kStraight * most; };
  slopes.erase(std::unique(slopes.begin(), slopes.end(), alike), slopes.end());
  if (static_cast<double>(even) < kLeastEven * static_cast<double>(lines) ||
      2 * slopes.size() < lines || rows > kLongest_s * rate_hz) {
    return 0.0;
  }
  return rows;
}

// A ramp of another kind is a signal: a counter has whole numbers.
bool counts_rows(const std::vector<double>& values) {
  constexpr double kCounting = 0.98;  // a byte begins again every 256 rows; lost rows are rarer
  const double usual = values[1] - values[0];
  if (usual == 0.0) return false;
  std::size_t same = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] != std::round(values[i])) return false;
    same += values[i] - values[i - 1] == usual ? 1u : 0u;
  }
  return static_cast<double>(same) >= kCounting * static_cast<double>(values.size() - 1);
}

std::vector<Place> overflows(const std::vector<double>& x) {
  constexpr double kJump = 0.75;    // of the range
  constexpr double kGentle = 0.25;  // likewise: all other steps
  const auto [low, high] = std::ranges::minmax(x);
  const double range = high - low;
  std::vector<Place> out;
  std::size_t others = 0;
  for (std::size_t i = 2; i + 1 < x.size(); ++i) {
    const double step = x[i] - x[i - 1];
    if (std::abs(step) < kGentle * range) continue;
    const double before = x[i - 1] - x[i - 2];
    const double after = x[i + 1] - x[i];
    const bool against = before * step < 0.0 && after * step < 0.0 &&
                         std::max(std::abs(before), std::abs(after)) < kGentle * range;
    if (std::abs(step) >= kJump * range && against) {
      out.push_back({i, i + 1});
    } else {
      ++others;
    }
  }
  return out.size() < 2 || 4 * others > out.size() || beat(out) ? std::vector<Place>() : out;
}

std::size_t coarse_levels(const std::vector<double>& values) {
  constexpr std::size_t kFewest = 4;    // fewer are a switch
  constexpr double kLeastError = 0.01;  // of the variance, as what is held
  std::vector<double> levels = values;
  std::ranges::sort(levels);
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  if (levels.size() < kFewest) return 0;
  double step = levels[1] - levels[0];
  for (std::size_t i = 2; i < levels.size(); ++i) step = std::min(step, levels[i] - levels[i - 1]);
  const double deviation = deviation_of(values);
  return step * step / 12.0 >= kLeastError * deviation * deviation ? levels.size() : 0;
}

}  // namespace stillhand::measurement
