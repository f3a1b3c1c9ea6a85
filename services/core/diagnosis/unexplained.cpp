// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/unexplained.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "services/core/signal/spectrum.hpp"

namespace stillhand::diagnosis {
namespace {

// The band that holds the middle 80 % of a residual's power.
std::array<double, 2> band_of(const Eigen::VectorXd& residual, double rate_hz) {
  const std::vector<double> r(residual.data(), residual.data() + residual.size());
  std::size_t segment = 1024;
  while (segment > r.size()) segment /= 2;
  const signal::CrossSpectra spectra = signal::cross_spectra(r, r, rate_hz, segment);
  const double total = std::accumulate(spectra.s_xx.begin(), spectra.s_xx.end(), 0.0);
  std::array<double, 2> band{0.0, 0.5 * rate_hz};
  double sum = 0.0;
  for (std::size_t k = 0; k < spectra.s_xx.size(); ++k) {
    if (sum < 0.1 * total && sum + spectra.s_xx[k] >= 0.1 * total) {
      band[0] = spectra.frequency_hz[k];
    }
    if (sum < 0.9 * total && sum + spectra.s_xx[k] >= 0.9 * total) {
      band[1] = spectra.frequency_hz[k];
    }
    sum += spectra.s_xx[k];
  }
  return band;
}

// What one question found, in words.
std::string finding(const Detection& detection) {
  const std::string share =
      std::to_string(std::lround(100.0 * detection.share)) + " % of its power";
  if (detection.question == kDistortion) {
    return "the residual repeats with the excitation at " + detection.channel +
           ", where a linear system does not respond (" + share +
           "): distortion that no kind of effect explains";
  }
  return "the residual still depends on: " + detection.question + " " + detection.channel + " (" +
         share + ", held out), which no kind of effect explains";
}

}  // namespace

std::optional<Unexplained> unexplained_of(const DetectionResult& detections,
                                          const Screening& screening) {
  constexpr std::size_t kMostChannels = 3;
  Unexplained left;
  for (const Detection& detection : detections.detections) {
    if (!detection.found) continue;
    if (left.what.empty()) left.what = finding(detection);
    for (const std::string& channel : detection.channels) {
      if (left.channels.size() == kMostChannels) break;
      if (std::ranges::find(left.channels, channel) == left.channels.end()) {
        left.channels.push_back(channel);
      }
    }
  }
  if (left.what.empty()) return {};
  left.band_hz = band_of(screening.residual(), screening.signals().rate_hz());
  std::vector<std::size_t> order(detections.spread.rms.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
    return detections.spread.rms[a] > detections.spread.rms[b];
  });
  for (std::size_t i = 0; i < std::min<std::size_t>(3, order.size()); ++i) {
    left.times_s.push_back(detections.spread.time_s[order[i]]);
  }
  std::ranges::sort(left.times_s);
  return left;
}

}  // namespace stillhand::diagnosis
