// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/parts/adaptive_gain.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/contract/tick.hpp"
#include "services/core/contract/units.hpp"

namespace stillhand::cancellation {
namespace {

constexpr double kDt = kControlPeriod_s;
// Paper III-C: the platform moves between 0.7 and 2 Hz; the middle in log frequency is 1.2 Hz.
constexpr double kBandLow_hz = 0.5;
constexpr double kBandHigh_hz = 3.0;
constexpr double kMiddle_rad_s = kTwoPi * 1.2;
// The derivative is one below this frequency, well above the band.
constexpr double kDerivativeLag_s = 1.0 / (kTwoPi * 15.0);
// Eq. CC-11: slow against the operator's own motion, fast against a hand that tightens.
constexpr double kConvergence_s = 15.0;
constexpr double kPower_s = 10.0;
constexpr double kLeastMotion_m2 = 1e-4 * 1e-4;
constexpr double kFastest_s = 5.0;  // for a weight to change by 1
// Eq. CC-12: a force that is to go to zero takes its phase along.
constexpr double kMostGain = 1.5;
constexpr double kMostPhase = 0.7;  // tan of 35 degrees at 1.2 Hz
// Eq. CC-13.
constexpr double kJudged_s = 5.0;
constexpr double kWorse = 1.1;
constexpr double kBackOff_s = 0.5;

}  // namespace

AdaptiveGain::AdaptiveGain()
    : band_r0_(2, kBandLow_hz, kBandHigh_hz, kControlRateHz), band_x_(band_r0_) {}

AdaptiveGain::AdaptiveGain(const HandCompliance& compliance) : AdaptiveGain() {
  const double natural_rad_s = std::sqrt(compliance.stiffness_n_m / compliance.mass_kg);
  lag_.emplace(natural_rad_s, compliance.damping_n_s_m / (2.0 * natural_rad_s * compliance.mass_kg),
               kDt);
  compliance_m_n_ = 1.0 / compliance.stiffness_n_m;
  lever_m_ = compliance.lever_m;
}

void AdaptiveGain::reset() noexcept {
  if (lag_) lag_->reset();
  band_r0_.reset();
  band_x_.reset();
  slow_n_ = slow_r0_ = 0.0;
}

double AdaptiveGain::step(double predicted_n, double theta_rad, bool acting) noexcept {
  if (!lag_) return predicted_n;
  const double blend = kDt / (kDerivativeLag_s + kDt);
  const auto derivative = [blend](double value, double& slow) {
    slow += blend * (value - slow);
    return (value - slow) / (kDerivativeLag_s * kMiddle_rad_s);
  };
  const double r0 = band_r0_.step(lag_->step(predicted_n * compliance_m_n_).x);
  const Pair r{r0, derivative(r0, slow_r0_)};
  const double e = band_x_.step(lever_m_ * theta_rad);
  if (acting) {
    adapt(r, e);
    back_off(r, e);
  }
  const double quadrature_n = derivative(predicted_n, slow_n_);
  return weights_[0] * predicted_n + weights_[1] * quadrature_n;
}

void AdaptiveGain::adapt(const Pair& r, double e) noexcept {
  constexpr double kBlend = kDt / kPower_s;
  power_[0] += kBlend * (r[0] * r[0] - power_[0]);
  power_[1] += kBlend * (r[0] * r[1] - power_[1]);
  power_[2] += kBlend * (r[1] * r[1] - power_[2]);
  // Regularised: without motion nothing is learnt.
  const double a = power_[0] + kLeastMotion_m2;
  const double d = power_[2] + kLeastMotion_m2;
  const double determinant = a * d - power_[1] * power_[1];
  const Pair towards{(d * r[0] - power_[1] * r[1]) * e / determinant,
                     (a * r[1] - power_[1] * r[0]) * e / determinant};
  constexpr double kMost = kDt / kFastest_s;
  for (std::size_t i = 0; i < 2; ++i) {
    const double change = kDt / kConvergence_s * towards[i];
    if (std::isfinite(change)) weights_[i] += std::clamp(change, -kMost, kMost);
  }
  weights_[0] = std::clamp(weights_[0], 0.0, kMostGain);
  const double most = kMostPhase * weights_[0];
  weights_[1] = std::clamp(weights_[1], -most, most);
}

void AdaptiveGain::back_off(const Pair& r, double e) noexcept {
  constexpr double kBlend = kDt / kJudged_s;
  const double without = e + weights_[0] * r[0] + weights_[1] * r[1];
  moved_ += kBlend * (e * e - moved_);
  unmoved_ += kBlend * (without * without - unmoved_);
  if (moved_ > kWorse * unmoved_ + kLeastMotion_m2) {
    for (double& weight : weights_) weight -= kDt / kBackOff_s * weight;
  }
}

}  // namespace stillhand::cancellation
