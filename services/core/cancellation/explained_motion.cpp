// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/explained_motion.hpp"

#include <cmath>

namespace stillhand::cancellation {
namespace {

constexpr double kBandLow_hz = 0.5;
constexpr double kBandHigh_hz = 3.0;

signal::SecondOrderLag lag_of(const HandCompliance& hand) {
  const double natural_rad_s = std::sqrt(hand.stiffness_n_m / hand.mass_kg);
  return {natural_rad_s, hand.damping_n_s_m / (2.0 * natural_rad_s * hand.mass_kg),
          kControlPeriod_s};
}

}  // namespace

ExplainedMotion::ExplainedMotion(const HandCompliance& compliance)
    : lag_(lag_of(compliance)),
      compliance_m_n_(1.0 / compliance.stiffness_n_m),
      lever_m_(compliance.lever_m),
      band_r0_(2, kBandLow_hz, kBandHigh_hz, kControlRateHz),
      band_x_(band_r0_) {}

ExplainedMotion::Output ExplainedMotion::step(double force_n, double theta_rad) noexcept {
  const double r0 = band_r0_.step(lag_.step(force_n * compliance_m_n_).x);
  return {{r0, quadrature_.step(r0)}, band_x_.step(lever_m_ * theta_rad)};
}

void ExplainedMotion::reset() noexcept {
  lag_.reset();
  band_r0_.reset();
  band_x_.reset();
  quadrature_.reset();
}

}  // namespace stillhand::cancellation
