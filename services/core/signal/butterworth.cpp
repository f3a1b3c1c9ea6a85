// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/butterworth.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "services/core/contract/config_error.hpp"

namespace stillhand::signal {
namespace {

// First-order section: analogue w/(s + w) or s/(s + w) with w prewarped.
Biquad first_order(double w, Passband pass) {
  const double norm = 1.0 / (1.0 + w);
  Biquad q;
  q.a1 = (w - 1.0) * norm;
  q.b0 = (pass == Passband::kLow ? w : 1.0) * norm;
  q.b1 = pass == Passband::kLow ? q.b0 : -q.b0;
  return q;
}

// Second-order section with damping term d = 2 zeta: w^2/(s^2 + d w s + w^2), or s^2 over the same.
Biquad second_order(double w, double d, Passband pass) {
  const double norm = 1.0 / (1.0 + d * w + w * w);
  Biquad q;
  q.a1 = 2.0 * (w * w - 1.0) * norm;
  q.a2 = (1.0 - d * w + w * w) * norm;
  q.b0 = (pass == Passband::kLow ? w * w : 1.0) * norm;
  q.b1 = pass == Passband::kLow ? 2.0 * q.b0 : -2.0 * q.b0;
  q.b2 = q.b0;
  return q;
}

}  // namespace

Butterworth::Butterworth(int order, double cutoff_hz, double rate_hz, Passband pass) {
  if (order < 1 || order > kMaxOrder) {
    throw ConfigError("butterworth.order", std::to_string(order),
                      "1 to " + std::to_string(kMaxOrder));
  }
  if (!(rate_hz > 0.0) || !(cutoff_hz > 0.0) || !(cutoff_hz < rate_hz / 2.0)) {
    throw ConfigError("butterworth.cutoff_hz", std::to_string(cutoff_hz),
                      "0 < cutoff_hz < " + std::to_string(rate_hz / 2.0) + " (Nyquist)");
  }
  const double w = std::tan(std::numbers::pi * cutoff_hz / rate_hz);
  if (order % 2 == 1) sections_[section_count_++] = first_order(w, pass);
  for (int k = 0; k < order / 2; ++k) {
    // Pole pair at angle theta from the negative real axis: d = 2 cos(theta).
    const double theta = std::numbers::pi * (order % 2 == 1 ? k + 1.0 : k + 0.5) / order;
    sections_[section_count_++] = second_order(w, 2.0 * std::cos(theta), pass);
  }
}

void Butterworth::reset() noexcept {
  for (Biquad& section : sections_) section.reset();
}

std::vector<double> filtered(Butterworth filter, const std::vector<double>& samples) {
  std::vector<double> out;
  out.reserve(samples.size());
  for (const double x : samples) out.push_back(filter.step(x));
  return out;
}

}  // namespace stillhand::signal
