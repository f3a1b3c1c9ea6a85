// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/frequency_response.hpp"

#include <cmath>
#include <numbers>

#include "services/core/contract/expects.hpp"

namespace stillhand::identification {

std::vector<ResponsePoint> frequency_response(const DifferenceModel& model,
                                              const std::vector<double>& frequencies_hz) {
  STILLHAND_EXPECTS(signal::well_formed(model));
  std::vector<ResponsePoint> points;
  points.reserve(frequencies_hz.size());
  for (const double f : frequencies_hz) {
    const std::complex<double> h = signal::response_at(model, f);
    points.push_back({f, 20.0 * std::log10(std::abs(h)), std::arg(h) * 180.0 / std::numbers::pi});
  }
  return points;
}

std::vector<double> log_spaced_hz(double low_hz, double high_hz, int count) {
  STILLHAND_EXPECTS(low_hz > 0.0 && high_hz > low_hz && count >= 2);
  std::vector<double> frequencies;
  for (int i = 0; i < count; ++i) {
    frequencies.push_back(low_hz * std::pow(high_hz / low_hz, i / (count - 1.0)));
  }
  return frequencies;
}

}  // namespace stillhand::identification
