// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/parts/adaptive_gain.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/contract/tick.hpp"

namespace stillhand::cancellation {
namespace {

constexpr double kDt = kControlPeriod_s;
// Eq. CC-11: slow against the operator's own motion, fast against a hand that tightens.
constexpr double kConvergence_s = 15.0;
constexpr double kPower_s = 10.0;
constexpr double kLeastPower_m2 = 1e-4 * 1e-4;
constexpr double kFastest_s = 5.0;  // for a weight to change by 1
// Eq. CC-12: a force that is to go to zero takes its phase along.
constexpr double kMostGain = 1.5;
constexpr double kMostPhase = 0.7;  // tan of 35 degrees at 1.2 Hz
// Eq. CC-13.
constexpr double kJudged_s = 5.0;
constexpr double kWorse = 1.1;
constexpr double kBackOff_s = 0.5;

}  // namespace

void AdaptiveGain::reset() noexcept {
  if (motion_) motion_->reset();
  quadrature_.reset();
}

double AdaptiveGain::step(double predicted_n, double theta_rad, bool acting) noexcept {
  if (!motion_) return predicted_n;
  const auto [r, e] = motion_->step(predicted_n, theta_rad);
  if (acting) {
    adapt(r, e);
    back_off(r, e);
  }
  return weights_[0] * predicted_n + weights_[1] * quadrature_.step(predicted_n);
}

void AdaptiveGain::adapt(const Pair& r, double e) noexcept {
  constexpr double kBlend = kDt / kPower_s;
  power_[0] += kBlend * (r[0] * r[0] - power_[0]);
  power_[1] += kBlend * (r[0] * r[1] - power_[1]);
  power_[2] += kBlend * (r[1] * r[1] - power_[2]);
  // Regularised: without motion nothing is learnt.
  const double a = power_[0] + kLeastPower_m2;
  const double d = power_[2] + kLeastPower_m2;
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
  if (moved_ > kWorse * unmoved_ + kLeastPower_m2) {
    for (double& weight : weights_) weight -= kDt / kBackOff_s * weight;
  }
}

}  // namespace stillhand::cancellation
