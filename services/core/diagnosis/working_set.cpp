// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/working_set.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/record/digits.hpp"
#include "services/core/signal/butterworth.hpp"
#include "services/core/signal/spectrum.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kRateOverBand = 20.0;
constexpr double kLowestRate_hz = 100.0;
constexpr double kCutoff = 0.4;  // of the new rate
constexpr std::size_t kPieces = 40;
constexpr std::size_t kShortestPiece = 50;
constexpr std::size_t kSegment = 4096;
constexpr int kDigits = 6;  // of a rate in a message

// [Hz] above which lies a thousandth of the inputs' power.
double highest_excited_hz(const Measurement& measurement, const std::vector<std::string>& inputs) {
  double highest = 0.0;
  for (const std::string& name : inputs) {
    const Channel* input = measurement.find(name);
    if (input == nullptr) continue;
    std::size_t segment = kSegment;
    while (segment > input->values.size() && segment > 8) segment /= 2;
    const auto spectra =
        signal::cross_spectra(input->values, input->values, measurement.rate_hz, segment);
    double total = 0.0;
    for (const double s : spectra.s_xx) total += s;
    if (!(total > 0.0)) continue;
    double above = 0.0;
    std::size_t k = spectra.s_xx.size();
    while (k > 1 && above < 1e-3 * total) above += spectra.s_xx[--k];
    highest = std::max(highest, spectra.frequency_hz[k]);
  }
  return highest;
}

std::vector<double> smoothed(const std::vector<double>& x, const signal::Butterworth& low_pass) {
  // About the first value, so that neither end starts with a step.
  std::vector<double> y = x;
  for (int pass = 0; pass < 2; ++pass) {
    const double start = y.front();
    for (double& value : y) value -= start;
    y = signal::filtered(low_pass, y);
    for (double& value : y) value += start;
    std::ranges::reverse(y);
  }
  return y;
}

Measurement thinned(const Measurement& measurement) {
  Measurement result;
  result.source = measurement.source;
  result.notes = measurement.notes;
  result.rate_hz = measurement.rate_hz;
  for (const Channel& channel : measurement.channels) {
    result.channels.push_back({channel.name, channel.unit, {}});
  }
  for (const Stretch& piece :
       spread_pieces(measurement.stretches, kPieces, kMostSamples, measurement.rate_hz)) {
    const auto from = static_cast<std::ptrdiff_t>(piece.first);
    const auto to = static_cast<std::ptrdiff_t>(piece.end);
    const std::size_t at = result.weight.size();
    result.weight.insert(result.weight.end(), measurement.weight.begin() + from,
                         measurement.weight.begin() + to);
    for (std::size_t c = 0; c < result.channels.size(); ++c) {
      const auto& values = measurement.channels[c].values;
      result.channels[c].values.insert(result.channels[c].values.end(), values.begin() + from,
                                       values.begin() + to);
    }
    result.stretches.push_back({at, result.weight.size(), piece.start_s, piece.recording});
  }
  result.notes.push_back("of " + std::to_string(measurement.size()) + " samples " +
                         std::to_string(result.size()) + " in " +
                         std::to_string(result.stretches.size()) +
                         " pieces spread evenly over the record were used");
  return result;
}

}  // namespace

std::vector<Stretch> spread_pieces(const std::vector<Stretch>& stretches, std::size_t pieces,
                                   std::size_t most, double rate_hz) {
  const std::size_t piece = most / pieces;
  const std::size_t step = stretches.back().end / pieces;
  std::vector<Stretch> result;
  for (const Stretch& stretch : stretches) {
    // Pieces begin at multiples of the step; a stretch's end cuts them.
    for (std::size_t begin = stretch.first / step * step; begin < stretch.end; begin += step) {
      const std::size_t first = std::max(begin, stretch.first);
      const std::size_t end = std::min(begin + piece, stretch.end);
      if (end < first + kShortestPiece) continue;
      const double start_s = stretch.start_s + static_cast<double>(first - stretch.first) / rate_hz;
      result.push_back({first, end, start_s, stretch.recording});
    }
  }
  return result;
}

Measurement decimated(const Measurement& measurement, std::size_t factor) {
  Measurement result;
  result.source = measurement.source;
  result.notes = measurement.notes;
  result.rate_hz = measurement.rate_hz / static_cast<double>(factor);
  for (const Channel& channel : measurement.channels) {
    result.channels.push_back({channel.name, channel.unit, {}});
  }
  const signal::Butterworth low_pass(8, kCutoff * result.rate_hz, measurement.rate_hz);
  for (const Stretch& stretch : measurement.stretches) {
    if (stretch.end - stretch.first < factor) continue;
    const std::size_t first = result.weight.size();
    // Whole groups only, so that a stretch never grows.
    for (std::size_t n = stretch.first; n + factor <= stretch.end; n += factor) {
      const std::size_t end = n + factor;
      result.weight.push_back(
          *std::min_element(measurement.weight.begin() + static_cast<std::ptrdiff_t>(n),
                            measurement.weight.begin() + static_cast<std::ptrdiff_t>(end)));
    }
    for (std::size_t c = 0; c < result.channels.size(); ++c) {
      const auto& values = measurement.channels[c].values;
      const auto smooth = smoothed({values.begin() + static_cast<std::ptrdiff_t>(stretch.first),
                                    values.begin() + static_cast<std::ptrdiff_t>(stretch.end)},
                                   low_pass);
      for (std::size_t n = 0; n + factor <= smooth.size(); n += factor) {
        result.channels[c].values.push_back(smooth[n]);
      }
    }
    result.stretches.push_back({first, result.weight.size(), stretch.start_s, stretch.recording});
  }
  result.notes.push_back("the inputs end far below " + digits(measurement.rate_hz / 2.0, kDigits) +
                         " Hz: the engine works at " + digits(result.rate_hz, kDigits) + " Hz");
  return result;
}

std::size_t rate_factor(const Measurement& measurement, double rate_hz) {
  constexpr double kSame = 4e-3;     // the clock of a recording with much jitter is off by as much
  constexpr double kLargest = 1e15;  // exact as a double, and a std::size_t
  const double ratio = measurement.rate_hz / rate_hz;
  const double whole = std::round(ratio);
  if (!(whole >= 1.0 && whole <= kLargest && std::abs(ratio - whole) <= kSame * whole)) {
    throw ConfigError(
        measurement.source, "samples at " + digits(measurement.rate_hz, kDigits) + " Hz",
        "the model's rate, " + digits(rate_hz, kDigits) + " Hz, or a whole multiple of it");
  }
  return static_cast<std::size_t>(whole);
}

Measurement working_set(const Measurement& measurement, const std::vector<std::string>& inputs) {
  const double band_hz = highest_excited_hz(measurement, inputs);
  const double wanted_hz = std::max(kLowestRate_hz, kRateOverBand * band_hz);
  const auto factor = static_cast<std::size_t>(measurement.rate_hz / wanted_hz);
  Measurement result = factor >= 2 ? decimated(measurement, factor) : measurement;
  return result.size() > kMostSamples ? thinned(result) : result;
}

}  // namespace stillhand::diagnosis
