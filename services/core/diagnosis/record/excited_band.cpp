// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/record/excited_band.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numeric>
#include <unsupported/Eigen/FFT>
#include <utility>

namespace stillhand::diagnosis {
namespace {

constexpr double kOutside = 0.01;  // of the power, on each side of the band

// |X(k)|^2 of the lines from 0 to half the rate.
struct Lines {
  std::vector<double> power;
  double step_hz = 0.0;
};

Lines lines_of(std::vector<double> x, double mean, double rate_hz) {
  for (double& value : x) value -= mean;
  x.resize(std::bit_ceil(std::max<std::size_t>(x.size(), 2)), 0.0);  // Eigen's transform wants two
  std::vector<std::complex<double>> spectrum;
  Eigen::FFT<double> transform;
  transform.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  transform.fwd(spectrum, x);
  Lines lines;
  for (const auto& line : spectrum) lines.power.push_back(std::norm(line));
  lines.step_hz = rate_hz / static_cast<double>(x.size());
  return lines;
}

}  // namespace

ExcitedBand excited_band(std::string name, const std::vector<double>& values, double mean,
                         double rate_hz) {
  const Lines lines = lines_of(values, mean, rate_hz);
  const double total = std::accumulate(lines.power.begin(), lines.power.end(), 0.0);
  ExcitedBand band{std::move(name), 0.5 * rate_hz, 0.0};
  double sum = 0.0;
  for (std::size_t k = 0; k < lines.power.size(); ++k) {
    const double before = sum;
    sum += lines.power[k];
    const double at_hz = lines.step_hz * static_cast<double>(k);
    if (before < kOutside * total && sum >= kOutside * total) band.low_hz = at_hz;
    if (before < (1.0 - kOutside) * total && sum >= (1.0 - kOutside) * total) band.high_hz = at_hz;
  }
  return band;
}

double power_outside(const ExcitedBand& band, const std::vector<double>& values, double mean,
                     double rate_hz) {
  const Lines lines = lines_of(values, mean, rate_hz);
  double outside = 0.0;
  double total = 0.0;
  for (std::size_t k = 0; k < lines.power.size(); ++k) {
    const double at_hz = lines.step_hz * static_cast<double>(k);
    total += lines.power[k];
    if (at_hz < band.low_hz || at_hz > band.high_hz) outside += lines.power[k];
  }
  return total > 0.0 ? outside / total : 0.0;
}

}  // namespace stillhand::diagnosis
