// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/core/trial_forces.hpp"

#include <cmath>
#include <cstddef>

#include "services/core/signal/moments.hpp"

namespace stillhand::session {

double rms(std::span<const double> values) noexcept {
  return values.empty() ? 0.0 : signal::rms(values);
}

TrialForces trial_forces(const ForceSignals& signals, double rate_hz) {
  constexpr double kMean_s = 0.01;  // Eq. SN-5
  std::vector<double> left_n;
  for (std::size_t n = 0; n < signals.feedthrough_n.size(); ++n) {
    left_n.push_back(signals.feedthrough_n[n] + signals.motor_n[n]);
  }
  std::vector<double> acceleration_m_s2;
  const auto stride = static_cast<std::size_t>(std::lround(kMean_s * rate_hz));
  for (std::size_t n = 0; n + stride < signals.hand_m_s.size(); n += stride) {
    acceleration_m_s2.push_back((signals.hand_m_s[n + stride] - signals.hand_m_s[n]) / kMean_s);
  }
  return {rms(left_n), rms(acceleration_m_s2), rms(signals.motor_n), rms(signals.volitional_n)};
}

}  // namespace stillhand::session
