// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "services/core/identification/record.hpp"
#include "services/core/signal/butterworth.hpp"
#include "services/core/signal/difference_model.hpp"
#include "services/core/signal/random.hpp"

namespace stillhand::support {

inline std::vector<double> white_noise(std::size_t count, double deviation, std::uint64_t seed) {
  signal::Gaussian draw(seed, 100);
  std::vector<double> out(count);
  for (double& x : out) x = deviation * draw();
  return out;
}

/// Noise of one band, fourth-order edges, scaled to an RMS.
inline std::vector<double> band_noise(std::size_t count, double rate_hz, double low_hz,
                                      double high_hz, double rms, std::uint64_t seed) {
  auto x =
      signal::filtered(signal::Butterworth(4, high_hz, rate_hz), white_noise(count, 1.0, seed));
  x = signal::filtered(signal::Butterworth(4, low_hz, rate_hz, signal::Passband::kHigh), x);
  double power = 0.0;
  for (const double v : x) power += v * v;
  for (double& v : x) v *= rms / std::sqrt(power / static_cast<double>(count));
  return x;
}

/// A body-like model at 50 Hz: -3.2 N s^2/m at 0 Hz, poles near 3.3 Hz (damping ratio 0.27) and
/// 9 Hz (0.2), a notch near 6 Hz.
inline signal::DifferenceModel body_like_model() {
  // Pole and zero pairs by radius and angle: z^2 - 2 r cos(w) z + r^2.
  const auto pair = [](double radius, double hz) {
    const double angle_rad = 2.0 * 3.14159265358979323846 * hz / 50.0;
    return std::vector<double>{1.0, -2.0 * radius * std::cos(angle_rad), radius * radius};
  };
  const auto times = [](const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> out(a.size() + b.size() - 1, 0.0);
    for (std::size_t i = 0; i < a.size(); ++i) {
      for (std::size_t j = 0; j < b.size(); ++j) out[i + j] += a[i] * b[j];
    }
    return out;
  };
  signal::DifferenceModel model{50.0, times(pair(0.93, 6.0), pair(0.5, 15.0)),
                                times(pair(0.88, 3.3), pair(0.80, 9.0))};
  const double scale = -3.2 / signal::response_at(model, 0.0).real();
  for (double& c : model.numerator) c *= scale;
  return model;
}

/// Record of a model without noise.
inline identification::Record record_of(const signal::DifferenceModel& model,
                                        std::vector<double> acceleration_m_s2) {
  auto force_n = signal::simulated(model, acceleration_m_s2);
  return {model.rate_hz, std::move(acceleration_m_s2), std::move(force_n)};
}

}  // namespace stillhand::support
