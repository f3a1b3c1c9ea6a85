// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/multisine.hpp"

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/units.hpp"

namespace stillhand::signal {
namespace {

void check(const Component& component, std::int64_t samples_per_period, std::size_t index) {
  const std::string key = "multisine.components[" + std::to_string(index) + "].";
  if (component.harmonic <= 0 || 2 * component.harmonic >= samples_per_period) {
    throw ConfigError(key + "harmonic", std::to_string(component.harmonic),
                      "0 < k < " + std::to_string((samples_per_period + 1) / 2) + " (Nyquist)");
  }
  if (!std::isfinite(component.amplitude_m_s2)) {
    throw ConfigError(key + "amplitude_m_s2", std::to_string(component.amplitude_m_s2),
                      "a finite value");
  }
  if (!std::isfinite(component.phase_rad)) {
    throw ConfigError(key + "phase_rad", std::to_string(component.phase_rad), "a finite value");
  }
}

}  // namespace

Multisine::Multisine(std::int64_t samples_per_period, double rate_hz,
                     std::vector<Component> components)
    : samples_per_period_(samples_per_period),
      rate_hz_(rate_hz),
      components_(std::move(components)) {
  if (samples_per_period < 4 || samples_per_period > kMaxPeriod) {
    throw ConfigError("multisine.samples_per_period", std::to_string(samples_per_period),
                      "4 to " + std::to_string(kMaxPeriod));
  }
  if (!(rate_hz > 0.0) || !std::isfinite(rate_hz)) {
    throw ConfigError("multisine.rate_hz", std::to_string(rate_hz), "a positive finite value");
  }
  for (std::size_t i = 0; i < components_.size(); ++i) check(components_[i], samples_per_period, i);
}

MotionSample Multisine::at(std::int64_t n) const noexcept {
  MotionSample sum{0.0, 0.0, 0.0};
  const auto period = static_cast<double>(samples_per_period_);
  const std::int64_t within = n % samples_per_period_;
  for (const Component& c : components_) {
    const std::int64_t step = c.harmonic * within % samples_per_period_;
    const double angle_rad = kTwoPi * (static_cast<double>(step) / period) + c.phase_rad;
    const double w_rad_s = kTwoPi * static_cast<double>(c.harmonic) * rate_hz_ / period;
    const double accel_m_s2 = c.amplitude_m_s2 * std::sin(angle_rad);
    sum.accel_m_s2 += accel_m_s2;
    sum.vel_m_s -= c.amplitude_m_s2 / w_rad_s * std::cos(angle_rad);
    sum.pos_m -= accel_m_s2 / (w_rad_s * w_rad_s);
  }
  return sum;
}

std::vector<double> schroeder_phases(const std::vector<double>& amplitudes) {
  double total = 0.0;
  for (const double a : amplitudes) total += a * a;
  std::vector<double> phases_rad;
  phases_rad.reserve(amplitudes.size());
  // sum_{j<k} (k - j) p_j grows by the sum of p_j so far with each k.
  double power_below = 0.0;
  double turns = 0.0;
  for (const double a : amplitudes) {
    turns -= power_below;
    phases_rad.push_back(kTwoPi * (turns - std::floor(turns)));
    if (total > 0.0) power_below += a * a / total;
  }
  return phases_rad;
}

}  // namespace stillhand::signal
