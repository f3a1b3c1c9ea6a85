// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/paper_preprocessing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/core/signal/butterworth.hpp"

namespace stillhand::identification {
namespace {

constexpr int kAntiAliasOrder = 8;
constexpr double kAntiAliasHz = 40.0;
constexpr int kPaperOrder = 5;
constexpr double kPaperCutoffHz = 10.0;
// A rate found from time stamps is a little off: 1e-6 of it is 0.1 ms in the paper's two minutes.
constexpr double kRateTolerance = 1e-6;
// Half width of the resampling kernel [samples].  With a Hann window its transition is 4/32 of the
// rate wide each side of Nyquist, clear of the 10 Hz that are kept.
constexpr double kSincHalfWidth = 32.0;

std::vector<double> every(const std::vector<double>& samples, std::size_t stride) {
  std::vector<double> out;
  out.reserve(samples.size() / stride + 1);
  for (std::size_t n = 0; n < samples.size(); n += stride) out.push_back(samples[n]);
  return out;
}

double windowed_sinc(double offset) {
  if (offset == 0.0) return 1.0;
  const double x = std::numbers::pi * offset;
  return std::sin(x) / x * (0.5 + 0.5 * std::cos(x / kSincHalfWidth));
}

// Band-limited interpolation at times m / to_hz; near the ends the missing samples count as 0.
std::vector<double> resampled(const std::vector<double>& samples, double from_hz, double to_hz) {
  std::vector<double> out;
  const auto last = static_cast<double>(samples.size() - 1);
  for (std::size_t m = 0;; ++m) {
    const double at = static_cast<double>(m) * from_hz / to_hz;
    if (at > last) break;
    const double begin = std::max(0.0, std::ceil(at - kSincHalfWidth));
    const double end = std::min(last, std::floor(at + kSincHalfWidth));
    double sum = 0.0;
    for (double n = begin; n <= end; n += 1.0) {
      sum += samples[static_cast<std::size_t>(n)] * windowed_sinc(at - n);
    }
    out.push_back(sum);
  }
  return out;
}

std::vector<double> at_recording_rate(const std::vector<double>& samples, double rate_hz) {
  if (rate_hz < kRecordingRateHz * (1.0 + kRateTolerance)) return samples;
  const auto smooth =
      filtered(signal::Butterworth(kAntiAliasOrder, kAntiAliasHz, rate_hz), samples);
  const double stride = rate_hz / kRecordingRateHz;
  if (std::abs(stride - std::round(stride)) < kRateTolerance * stride) {
    return every(smooth, static_cast<std::size_t>(std::lround(stride)));
  }
  return resampled(smooth, rate_hz, kRecordingRateHz);
}

std::vector<double> at_fit_rate(const std::vector<double>& samples, double rate_hz) {
  const signal::Butterworth low_pass(kPaperOrder, kPaperCutoffHz, kRecordingRateHz);
  return every(filtered(low_pass, at_recording_rate(samples, rate_hz)),
               static_cast<std::size_t>(kRecordingRateHz / kFitRateHz));
}

}  // namespace

Record preprocessed(const Record& recorded) {
  check(recorded);
  if (recorded.rate_hz < kLeastRecordingRateHz) {
    throw ConfigError("recording, sample rate [Hz]", std::to_string(recorded.rate_hz),
                      "100 Hz or more, the paper's recording rate");
  }
  if (static_cast<double>(recorded.size()) < recorded.rate_hz) {
    throw ConfigError("recording", std::to_string(recorded.size()) + " samples",
                      "a second or more");
  }
  return {kFitRateHz, at_fit_rate(recorded.acceleration_m_s2, recorded.rate_hz),
          at_fit_rate(recorded.force_n, recorded.rate_hz)};
}

}  // namespace stillhand::identification
