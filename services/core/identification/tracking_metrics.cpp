// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/tracking_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/signal/moments.hpp"
#include "services/core/signal/spectrum.hpp"

namespace stillhand::identification {
namespace {

using Complex = std::complex<double>;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Paper III-C: the box is 30 mm wide, moving RMS and dwell are of 10 s, and the line of the
// crossover is fitted to the lowest 11 of 15.
constexpr double kBoxHalfWidth_m = 0.015;
constexpr double kWindow_s = 10.0;
constexpr int kFittedLines = 11;
// Unexcited harmonics that measure the remnant next to a line.
constexpr int kNeighbours = 6;
// Rate below which samples aren't averaged any further [Hz]; the fastest line is at 4 Hz.
constexpr double kLeastRateHz = 100.0;

std::vector<double> difference(const std::vector<double>& left, const std::vector<double>& right) {
  std::vector<double> out(left.size());
  for (std::size_t n = 0; n < out.size(); ++n) out[n] = left[n] - right[n];
  return out;
}

void check(const TrackingRecord& record, const signal::ReferenceDesign& design) {
  if (!(record.rate_hz > 0.0) || record.target_m.size() != record.cursor_m.size()) {
    throw ConfigError(
        "tracking.cursor_m", std::to_string(record.cursor_m.size()) + " samples",
        std::to_string(record.target_m.size()) + ", as many as of the target, at a rate above 0");
  }
  // Neighbours of the highest line need room as well.
  const std::int64_t least = 2 * (design.harmonics.back() + kNeighbours);
  if (static_cast<std::int64_t>(record.target_m.size()) <= least) {
    throw ConfigError("tracking.target_m", std::to_string(record.target_m.size()) + " samples",
                      "more than " + std::to_string(least));
  }
  for (std::size_t n = 0; n < record.target_m.size(); ++n) {
    if (!std::isfinite(record.target_m[n]) || !std::isfinite(record.cursor_m[n])) {
      throw ConfigError("tracking.sample[" + std::to_string(n) + "]", "NaN or infinity",
                        "a finite value");
    }
  }
}

// Means of equal groups: the same filter on cursor and error, so their ratio at a line stays.
std::vector<double> thinned(const std::vector<double>& samples, std::size_t group) {
  std::vector<double> out(samples.size() / group, 0.0);
  for (std::size_t n = 0; n < out.size(); ++n) {
    for (std::size_t i = 0; i < group; ++i) out[n] += samples[n * group + i];
    out[n] /= static_cast<double>(group);
  }
  return out;
}

// Largest group that divides the record and leaves kLeastRateHz and twice the lines.
std::size_t group_size(const TrackingRecord& record, const signal::ReferenceDesign& design) {
  const auto most = static_cast<std::size_t>(std::max(1.0, record.rate_hz / kLeastRateHz));
  const auto lines = 4 * static_cast<std::size_t>(design.harmonics.back() + kNeighbours);
  for (std::size_t group = most; group > 1; --group) {
    if (record.target_m.size() % group == 0 && record.target_m.size() / group > lines) return group;
  }
  return 1;
}

std::vector<std::int64_t> neighbours(const signal::ReferenceDesign& design, std::int64_t harmonic) {
  std::vector<std::int64_t> out;
  const auto& used = design.harmonics;
  for (std::int64_t away = 1; out.size() < kNeighbours; ++away) {
    for (const std::int64_t candidate : {harmonic - away, harmonic + away}) {
      const bool free = std::find(used.begin(), used.end(), candidate) == used.end();
      if (candidate > 0 && free && out.size() < kNeighbours) out.push_back(candidate);
    }
  }
  return out;
}

// Signal over remnant at a line; infinite without remnant.
double snr(const std::vector<double>& samples, Complex line,
           const std::vector<std::int64_t>& beside) {
  double power = 0.0;
  for (const std::int64_t harmonic : beside) power += std::norm(signal::line_at(samples, harmonic));
  power /= static_cast<double>(beside.size());
  return std::norm(line) / power;
}

OpenLoopLine open_loop_line(const std::vector<double>& cursor, const std::vector<double>& error,
                            Complex x_e, std::int64_t harmonic,
                            const signal::ReferenceDesign& design) {
  const auto beside = neighbours(design, harmonic);
  const Complex x_p = signal::line_at(cursor, harmonic);
  OpenLoopLine line{};
  line.harmonic = harmonic;
  line.gain = x_p / x_e;
  line.cursor_snr = snr(cursor, x_p, beside);
  line.error_snr = snr(error, x_e, beside);
  return line;
}

// Eq. ID-16: the least-squares solution of 20 log10 |G| = 20 log10 f_c - 20 log10 f is a mean.
double slope_fit_hz(const OpenLoopLine* lines, int count) {
  double sum = 0.0;
  for (int k = 0; k < count; ++k) {
    sum += std::log10(std::abs(lines[k].gain)) + std::log10(lines[k].frequency_hz);
  }
  const double f = std::pow(10.0, sum / count);
  return std::isfinite(f) && f > 0.0 ? f : kNan;
}

// Eq. ID-15.  A line's expected power is that of the signal plus the remnant's.
double pooled_fit_hz(const OpenLoopLine* lines, const std::vector<Complex>& errors, int count) {
  double above = 0.0;
  double below = 0.0;
  for (int k = 0; k < count; ++k) {
    const OpenLoopLine& line = lines[k];
    const double error_power = std::norm(errors[static_cast<std::size_t>(k)]);
    const double cursor_power = std::norm(line.gain) * error_power;
    above += line.frequency_hz * line.frequency_hz * cursor_power * (1.0 - 1.0 / line.cursor_snr);
    below += error_power * (1.0 - 1.0 / line.error_snr);
  }
  const double f = std::sqrt(above / below);
  return std::isfinite(f) && above > 0.0 && below > 0.0 ? f : kNan;
}

void add_open_loop(TrackingMetrics& out, const TrackingRecord& record,
                   const std::vector<double>& error_m, const signal::ReferenceDesign& design) {
  const std::size_t group = group_size(record, design);
  const std::vector<double> cursor = thinned(record.cursor_m, group);
  const std::vector<double> error = thinned(error_m, group);
  const double duration_s = static_cast<double>(record.target_m.size()) / record.rate_hz;
  std::vector<Complex> errors;
  for (std::size_t k = 0; k < signal::kReferenceLines; ++k) {
    const std::int64_t harmonic = design.harmonics[k];
    errors.push_back(signal::line_at(error, harmonic));
    out.lines[k] = open_loop_line(cursor, error, errors.back(), harmonic, design);
    out.lines[k].frequency_hz = static_cast<double>(harmonic) / duration_s;
  }
  out.crossover_hz = slope_fit_hz(out.lines.data(), kFittedLines);
  out.crossover_reference_hz = pooled_fit_hz(out.lines.data(), errors, kFittedLines);
}

// Eq. ID-17 by a sliding sum, summed again every window so that rounding cannot build up.
std::vector<double> moving_mean(const std::vector<double>& values, std::size_t window) {
  std::vector<double> out;
  if (window > values.size()) return out;
  out.reserve(values.size() - window + 1);
  double sum = 0.0;
  for (std::size_t first = 0; first + window <= values.size(); ++first) {
    if (first % window == 0) {
      sum = 0.0;
      for (std::size_t n = first; n < first + window; ++n) sum += values[n];
    } else {
      sum += values[first + window - 1] - values[first - 1];
    }
    out.push_back(std::max(0.0, sum / static_cast<double>(window)));
  }
  return out;
}

}  // namespace

TrackingMetrics tracking_metrics(const TrackingRecord& record,
                                 const signal::ReferenceDesign& design) {
  check(record, design);
  const std::vector<double> error_m = difference(record.target_m, record.cursor_m);
  std::vector<double> squared_mm2;
  std::vector<double> inside;
  for (const double e : error_m) {
    squared_mm2.push_back(e * kMmPerM * e * kMmPerM);
    inside.push_back(std::abs(e) < kBoxHalfWidth_m ? 1.0 : 0.0);
  }
  TrackingMetrics out;
  out.rms_error_mm = std::sqrt(signal::mean(squared_mm2));
  out.dwell_ratio = signal::mean(inside);
  add_open_loop(out, record, error_m, design);
  const auto window = static_cast<std::size_t>(std::lround(kWindow_s * record.rate_hz));
  out.moving_rms_mm = moving_mean(squared_mm2, window);
  for (double& value : out.moving_rms_mm) value = std::sqrt(value);
  out.moving_dwell = moving_mean(inside, window);
  return out;
}

}  // namespace stillhand::identification
