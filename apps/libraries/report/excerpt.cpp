// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/excerpt.hpp"

#include <algorithm>

#include "services/core/signal/spectrum.hpp"

namespace stillhand::report {
namespace {

constexpr double kExcerpt_s = 10.0;
constexpr double kFewestCycles = 4.0;
constexpr double kMostCycles = 100.0;
constexpr double kCycles = 40.0;

// [Hz] centre of the power.
double mean_frequency_hz(const std::vector<double>& values, double rate_hz) {
  std::size_t segment = 1024;
  while (segment > values.size()) segment /= 2;
  const auto spectra = signal::cross_spectra(values, values, rate_hz, segment);
  double power = 0.0;
  double moment = 0.0;
  for (std::size_t k = 1; k < spectra.s_xx.size(); ++k) {
    power += spectra.s_xx[k];
    moment += spectra.s_xx[k] * spectra.frequency_hz[k];
  }
  return power > 0.0 ? moment / power : 0.0;
}

}  // namespace

std::size_t excerpt_length(const std::vector<double>& values, double rate_hz) {
  const double frequency_hz = mean_frequency_hz(values, rate_hz);
  const double cycles = kExcerpt_s * frequency_hz;
  double length_s = kExcerpt_s;
  if (frequency_hz > 0.0 && (cycles < kFewestCycles || cycles > kMostCycles)) {
    length_s = kCycles / frequency_hz;
  }
  const double samples = std::min(length_s * rate_hz, static_cast<double>(values.size()));
  return std::max<std::size_t>(static_cast<std::size_t>(samples), 2);
}

}  // namespace stillhand::report
