// SPDX-License-Identifier: Apache-2.0
#include "services/core/clock/clock_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/core/contract/time_difference.hpp"

namespace stillhand::clock {
namespace {

constexpr double kLongest_s = 1.0;       // longest valid round trip
constexpr std::size_t kLeast = 8;        // exchanges before the first estimate
constexpr std::size_t kStepSamples = 3;  // consecutive exchanges that show a step
constexpr double kLeastStep_s = 1e-3;    // a smaller step can be network delay or drift
constexpr double kLeastSpan_s = 5.0;     // shortest span for a drift
constexpr double kPlainDrift = 20e-6;    // largest drift of a disciplined PC clock
constexpr double kToSigma = 1.4826;      // of a median absolute deviation, normal errors

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }
std::int64_t nanoseconds(double s) { return std::llround(1e9 * s); }

// Median of the first `count` values; reorders them.
template <std::size_t size>
double median(std::array<double, size>& values, std::size_t count) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(values.begin(), middle, values.begin() + static_cast<std::ptrdiff_t>(count));
  return *middle;
}

}  // namespace

bool ClockOffset::drifts() const noexcept {
  return std::abs(drift_ppm) - 3.0 * drift_sigma_ppm > 1e6 * kPlainDrift;
}

std::optional<std::int64_t> ClockComparison::take(const Exchange& exchange) noexcept {
  const std::int64_t there_ns = difference_ns(exchange.answered_ns, exchange.received_ns);
  const std::int64_t here_ns = difference_ns(exchange.back_ns, exchange.asked_ns);
  const double round_trip_s = seconds(here_ns - there_ns);
  if (here_ns < 0 || there_ns < 0 || round_trip_s < 0.0 || round_trip_s > kLongest_s)
    return std::nullopt;
  // Eq. CK-1; the differences come first because the clocks can be days apart.
  const std::int64_t offset_ns =
      difference_ns(exchange.received_ns, exchange.asked_ns) - (here_ns - there_ns) / 2;
  if (count_ == 0) {
    origin_ns_ = exchange.back_ns;
    origin_offset_ns_ = offset_ns;
  }
  const Sample sample{seconds(exchange.back_ns - origin_ns_),
                      seconds(offset_ns - origin_offset_ns_), round_trip_s};
  if (count_ > 0 && sample.at_s <= samples_[count_ - 1].at_s) return std::nullopt;

  double distance_s = 0.0;
  if (count_ >= kLeast) {
    const Line line = fitted();
    distance_s = sample.offset_s - (line.offset_s + line.drift * (sample.at_s - line.at_s));
    const double allowed_s =
        std::max(0.5 * sample.round_trip_s + 3.0 * line.spread_s, kLeastStep_s);
    const bool off_line = std::abs(distance_s) > allowed_s;
    const bool above = distance_s > 0.0;
    if (!off_line || above != away_above_) away_ = 0;
    if (off_line) ++away_;
    away_above_ = above;
  }
  if (count_ == kWindow) forget_but(kWindow - 1);
  samples_[count_++] = sample;
  if (away_ < kStepSamples) return std::nullopt;
  // Eq. CK-5: the clock has jumped; the earlier exchanges are invalid.
  ++steps_;
  forget_but(kStepSamples);
  away_ = 0;
  return nanoseconds(distance_s);
}

void ClockComparison::forget_but(std::size_t newest) noexcept {
  std::copy(samples_.begin() + static_cast<std::ptrdiff_t>(count_ - newest),
            samples_.begin() + static_cast<std::ptrdiff_t>(count_), samples_.begin());
  count_ = newest;
}

// Eq. CK-2 and CK-3.
ClockComparison::Line ClockComparison::fitted() const noexcept {
  std::array<double, kWindow> values{};
  for (std::size_t i = 0; i < count_; ++i) values[i] = samples_[i].round_trip_s;
  const double typical_s = median(values, count_);
  Line line;
  std::array<Sample, kWindow> quick{};
  for (std::size_t i = 0; i < count_; ++i) {
    if (samples_[i].round_trip_s <= typical_s) quick[line.used++] = samples_[i];
  }
  for (std::size_t i = 0; i < line.used; ++i) {
    line.at_s += quick[i].at_s / static_cast<double>(line.used);
  }
  const double span_s = quick[line.used - 1].at_s - quick[0].at_s;
  line.drift_sigma = std::numeric_limits<double>::infinity();
  if (span_s >= kLeastSpan_s) {
    std::array<double, kWindow * kWindow / 2> slopes{};
    std::size_t pairs = 0;
    for (std::size_t i = 0; i < line.used; ++i) {
      for (std::size_t j = i + 1; j < line.used; ++j) {
        slopes[pairs++] = (quick[j].offset_s - quick[i].offset_s) / (quick[j].at_s - quick[i].at_s);
      }
    }
    line.drift = median(slopes, pairs);
  }
  for (std::size_t i = 0; i < line.used; ++i) {
    values[i] = quick[i].offset_s - line.drift * (quick[i].at_s - line.at_s);
  }
  line.offset_s = median(values, line.used);
  const Sample& quickest = *std::ranges::min_element(
      quick.begin(), quick.begin() + static_cast<std::ptrdiff_t>(line.used), {},
      &Sample::round_trip_s);
  line.round_trip_s = quickest.round_trip_s;
  line.quickest_at_s = quickest.at_s;
  line.distance_s =
      std::abs(quickest.offset_s - line.offset_s - line.drift * (quickest.at_s - line.at_s));
  double square_s2 = 0.0;
  for (std::size_t i = 0; i < line.used; ++i) {
    const double along_s = quick[i].at_s - line.at_s;
    values[i] = std::abs(quick[i].offset_s - line.offset_s - line.drift * along_s);
    square_s2 += along_s * along_s;
  }
  line.spread_s = kToSigma * median(values, line.used);
  // The sigma of least squares times 1.5, because a median is less efficient.
  if (span_s >= kLeastSpan_s) line.drift_sigma = 1.5 * line.spread_s / std::sqrt(square_s2);
  return line;
}

std::optional<ClockOffset> ClockComparison::offset(std::int64_t now_ns) const noexcept {
  if (count_ < kLeast) return std::nullopt;
  const Line line = fitted();
  const double now_s = seconds(now_ns - origin_ns_);
  const double ahead_s = now_s - line.at_s;
  ClockOffset out;
  out.offset_ns = origin_offset_ns_ + nanoseconds(line.offset_s + line.drift * ahead_s);
  // Eq. CK-4.
  const double drift = std::isfinite(line.drift_sigma) ? 3.0 * line.drift_sigma : kPlainDrift;
  out.uncertainty_ns = 1e9 * (0.5 * line.round_trip_s + line.distance_s +
                              drift * std::abs(now_s - line.quickest_at_s));
  out.drift_ppm = 1e6 * line.drift;
  out.drift_sigma_ppm = 1e6 * line.drift_sigma;
  out.round_trip_ns = nanoseconds(line.round_trip_s);
  out.steps = steps_;
  return out;
}

}  // namespace stillhand::clock
