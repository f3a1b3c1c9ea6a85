// SPDX-License-Identifier: Apache-2.0
#include "apps/study/recorded/average.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

namespace stillhand::study {
namespace {

using Trials = std::vector<const TrackedTrial*>;
using identification::OpenLoopLine;
using identification::TrackingMetrics;

// Of the values that were found: a trial may have no crossover.
double mean_of(const Trials& trials, auto value) {
  double sum = 0.0;
  double count = 0.0;
  for (const TrackedTrial* trial : trials) {
    const double each = value(*trial);
    if (!std::isfinite(each)) continue;
    sum += each;
    count += 1.0;
  }
  return count > 0.0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

std::vector<double> mean_series(const Trials& trials,
                                std::vector<double> TrackingMetrics::* series) {
  std::vector<double> out((trials.front()->metrics.*series).size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = mean_of(trials, [&](const TrackedTrial& t) { return (t.metrics.*series)[i]; });
  }
  return out;
}

// The mean of the remnant's share, as a ratio of signal to remnant again.
double mean_snr(const Trials& trials, std::size_t line, double OpenLoopLine::* snr) {
  return 1.0 / mean_of(trials, [&](const TrackedTrial& t) {
           return std::min(1.0, 1.0 / (t.metrics.lines[line].*snr));
         });
}

// Magnitudes in decibels, angles as directions.
std::complex<double> mean_gain(const Trials& trials, std::size_t line) {
  double log_size = 0.0;
  std::complex<double> direction = 0.0;
  for (const TrackedTrial* trial : trials) {
    const std::complex<double> gain = trial->metrics.lines[line].gain;
    log_size += std::log(std::abs(gain));
    direction += gain / std::abs(gain);
  }
  return std::polar(std::exp(log_size / static_cast<double>(trials.size())), std::arg(direction));
}

}  // namespace

TrackedTrial averaged(const Trials& trials) {
  TrackedTrial out = *trials.back();
  if (trials.size() == 1) return out;
  out.closed_loop.resize(out.metrics.lines.size());
  for (std::size_t k = 0; k < out.metrics.lines.size(); ++k) {
    out.metrics.lines[k].gain = mean_gain(trials, k);
    out.metrics.lines[k].cursor_snr = mean_snr(trials, k, &OpenLoopLine::cursor_snr);
    out.metrics.lines[k].error_snr = mean_snr(trials, k, &OpenLoopLine::error_snr);
    std::complex<double> sum = 0.0;
    for (const TrackedTrial* trial : trials) {
      const std::complex<double> gain = trial->metrics.lines[k].gain;
      sum += gain / (1.0 + gain);
    }
    out.closed_loop[k] = sum / static_cast<double>(trials.size());
  }
  for (const session::Number& number : session::kNumbers) {
    number.place.in(out) =
        mean_of(trials, [&](const TrackedTrial& t) { return number.place.in(t); });
  }
  for (const auto series : {&TrackingMetrics::moving_rms_mm, &TrackingMetrics::moving_dwell}) {
    out.metrics.*series = mean_series(trials, series);
  }
  out.feedthrough_rms_n =
      mean_of(trials, [](const TrackedTrial& t) { return t.feedthrough_rms_n; });
  return out;
}

}  // namespace stillhand::study
