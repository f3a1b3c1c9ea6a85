// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/noise_floor.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "services/core/diagnosis/record/digits.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kAboveBand = 1.25;  // times the highest excited frequency: past a window's skirts
constexpr double kHighest = 0.3;     // of the rate: a decimated record ends at 0.4, DG-48
constexpr std::size_t kFewestLines = 4;
constexpr int kDigits = 4;  // of a number in `method`

// Freed of the numbers that were fitted to it and of what any question still explains, Eq. DG-19.
double final_model(const DetectionResult& after, const Screening& screening) {
  double share = 0.0;
  for (const Detection& detection : after.detections) {
    if (detection.found) share = std::max(share, detection.share);
  }
  const auto& weights = screening.weight();
  const double weight = std::accumulate(weights.begin(), weights.end(), 0.0);
  const auto numbers = static_cast<double>(complexity(screening.model()));
  const double own = screening.rmse() * std::sqrt(weight / std::max(weight - numbers, 1.0));
  return own * std::sqrt(1.0 - std::min(share, 1.0));
}

// The level above what the inputs excite, taken for the level below as well, Eq. DG-48; 0: there is
// no room above.  @param ratio  mean density within the excited band over that level
double high_frequencies(const CoherenceResult& spectra, const Signals& signals, double& ratio) {
  const double from_hz = kAboveBand * signals.highest_excited_hz();
  const double to_hz = kHighest * signals.rate_hz();
  double level = 0.0;
  double within = 0.0;
  double above = 0.0;
  std::size_t lines = 0;
  std::size_t inside = 0;
  for (std::size_t k = 0; k < spectra.frequency_hz.size(); ++k) {
    const double at_hz = spectra.frequency_hz[k];
    const double density = spectra.residual_density[k];
    if (at_hz > from_hz) above += density;
    if (at_hz > from_hz && at_hz < to_hz) {
      level += density;
      ++lines;
    }
    if (at_hz >= signals.lowest_excited_hz() && at_hz <= signals.highest_excited_hz()) {
      within += density;
      ++inside;
    }
  }
  if (lines < kFewestLines || !(level > 0.0)) return 0.0;
  level /= static_cast<double>(lines);
  ratio = inside > 0 ? within / static_cast<double>(inside) / level : 0.0;
  const double line_hz = spectra.frequency_hz[1] - spectra.frequency_hz[0];
  return std::sqrt(level * from_hz + above * line_hz);
}

void use_final_model(NoiseFloor& floor, const ErrorBounds& bounds) {
  floor.rmse = floor.estimates.front().rmse;
  floor.low = std::min(floor.rmse, bounds.low);
  floor.high = std::max(bounds.high, floor.rmse);
  if (bounds.impulse_response > 0.0) {
    floor.high = std::min(floor.high, std::max(bounds.impulse_response, floor.rmse));
  }
  floor.method =
      "the residual of the final model, without the part that tests of channels, state and time "
      "still explain, and corrected for the number of fitted values. Upper limit: that of the "
      "held-out error, or the residual of a long impulse response, if this is lower";
  // Noise can't be more than is left: an estimate beyond that end says nothing.
  for (const NoiseEstimate& other : floor.estimates) floor.low = std::min(floor.low, other.rmse);
  if (floor.estimates.size() > 1) floor.method += ". Lower limit: the smallest estimate";
}

void use_repeats(NoiseFloor& floor, const Repeats& repeats, const Periodicity& periodicity,
                 double rate_hz) {
  floor.rmse = repeats.rms;
  floor.low = repeats.low;
  floor.high = repeats.high;
  floor.method =
      "repeats: the standard deviation of the final model's residual between " +
      std::to_string(repeats.periods) + " periods of the excitation (" +
      digits(static_cast<double>(periodicity.period) / rate_hz, kDigits) + " s each" +
      (repeats.first_left_out ? ", without the first one, which differs" : "") +
      "), after the mean period is subtracted. The 95 % interval is that of chi-square with " +
      digits(repeats.degrees_of_freedom, kDigits) + " degrees of freedom";
}

}  // namespace

NoiseFloor noise_floor_of(const DetectionResult& after, const Screening& screening,
                          const ErrorBounds& bounds) {
  NoiseFloor floor;
  if (after.lines) floor.estimates.push_back({"repeats", after.lines->repeats.rms});
  floor.estimates.push_back({"final model", final_model(after, screening)});
  double ratio = 0.0;
  const double high = high_frequencies(after.coherence, screening.signals(), ratio);
  if (high > 0.0) floor.estimates.push_back({"high frequencies", high});
  if (after.coherence.incoherent_rms > 0.0) {
    floor.estimates.push_back({"between blocks", after.coherence.incoherent_rms});
  }
  if (after.lines) {
    use_repeats(floor, after.lines->repeats, after.lines->periodicity,
                screening.signals().rate_hz());
  } else {
    use_final_model(floor, bounds);
  }
  for (std::size_t i = 1; i < floor.estimates.size(); ++i) {
    const NoiseEstimate& other = floor.estimates[i];
    floor.method +=
        (i == 1 ? ". Other estimates: " : ", ") + other.name + " " + digits(other.rmse, kDigits);
    if (other.name == "high frequencies") {
      floor.method += " (the density in the excited band is " + digits(ratio, kDigits) +
                      " times the density above it)";
    }
  }
  return floor;
}

}  // namespace stillhand::diagnosis
