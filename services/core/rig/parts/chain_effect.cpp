// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/parts/chain_effect.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/core/contract/units.hpp"

namespace stillhand::rig {
namespace {

using Spring = ChainEffect::Spring;

/// A force on the arm, with its reaction on the trunk.
ChainForces at_shoulder(double on_arm_n) noexcept {
  return {.trunk_n = -on_arm_n, .arm_n = on_arm_n};
}

/// A force on the hand, with its reaction on the arm.
ChainForces at_grip(double on_hand_n) noexcept {
  return {.arm_n = -on_hand_n, .hand_n = on_hand_n};
}

// Of the reflex, RG-33: muscle spindles answer the rate of a stretch too.
constexpr double kRateOverStretch_s = 0.03;

std::size_t reflex_ticks(const ChainEffect& effect, double period_s) {
  if (effect.spring != Spring::kDelayedReflex) return 0;
  return static_cast<std::size_t>(std::lround(effect.time_s / period_s));
}

double drag(double c, double v_m_s) noexcept { return -c * v_m_s * std::abs(v_m_s); }

double beyond(double x, double threshold) noexcept {
  return x - std::clamp(x, -threshold, threshold);
}

}  // namespace

FractionalLadder::FractionalLadder(double exponent, double period_s) {
  constexpr double kLowest_hz = 0.002;
  constexpr double kApart = 3.0;
  const double weight = std::log(kApart) * std::sin(exponent * std::numbers::pi) / std::numbers::pi;
  double rate = kTwoPi * kLowest_hz;
  for (std::size_t i = 0; i < kLags; ++i) {
    gain_[i] = weight * std::pow(rate, exponent);
    blend_[i] = 1.0 - std::exp(-period_s * rate);
    rate *= kApart;
  }
}

void FractionalLadder::step(double x) noexcept {
  for (std::size_t i = 0; i < kLags; ++i) lag_[i] += blend_[i] * (x - lag_[i]);
}

double FractionalLadder::derivative(double x) const noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < kLags; ++i) sum += gain_[i] * (x - lag_[i]);
  return sum;
}

RestMode::RestMode(const ChainEffect& effect, double period_s)
    : lag_(kTwoPi * effect.rest_frequency_hz, effect.rest_damping, period_s),
      stiffness_n_m_(effect.rest_mass_kg * std::pow(kTwoPi * effect.rest_frequency_hz, 2)),
      pad_n_m_(effect.pad_stiffness_n_m),
      mass_kg_(effect.rest_mass_kg) {}

void RestMode::step(double arm_m, double acceleration_m_s2) noexcept {
  const double towards_m = (pad_n_m_ * arm_m - mass_kg_ * acceleration_m_s2) / stiffness_n_m_;
  lag_.step(towards_m);
  // A step gives the position at the start of the tick; the next step of a copy gives its end.
  position_m_ = signal::SecondOrderLag(lag_).step(towards_m).x;
}

EffectOnChain::EffectOnChain(const ChainEffect& effect, double period_s)
    : effect_(effect),
      rest_(effect, period_s),
      keep_(std::exp(-period_s / effect.time_s)),
      reflex_(reflex_ticks(effect, period_s)),
      ladder_(effect.exponent, period_s) {}

ChainForces EffectOnChain::forces(const ChainPlace& at, const ChainParameters& p) const noexcept {
  const ChainEffect& e = effect_;
  const double d_m = at.arm_m - at.trunk_m;
  const double s_m = at.arm_m - at.stick_m;
  switch (e.spring) {
    case Spring::kNone:
      return {};
    case Spring::kSofteningShoulder:
      return at_shoulder(p.shoulder_stiffness_n_m * e.factor *
                         (d_m - e.threshold_m * std::tanh(d_m / e.threshold_m)));
    case Spring::kHardeningGrip: {
      const double z = s_m / e.threshold_m;
      return at_grip(p.grip_stiffness_n_m * e.factor * s_m * z * z / (1.0 + z * z));
    }
    case Spring::kOneWayShoulder:
      return at_shoulder(-p.shoulder_stiffness_n_m * e.factor * std::abs(d_m));
    case Spring::kSlackHarness:
      return {.trunk_n = p.seat_stiffness_n_m * e.factor *
                         std::clamp(at.trunk_m, -e.threshold_m, e.threshold_m)};
    case Spring::kBumpStop:
      return {.trunk_n = -p.seat_stiffness_n_m * e.factor * beyond(at.trunk_m, e.threshold_m)};
    case Spring::kTighteningArm: {
      const double more = e.factor * (1.0 - slack_left_);
      const double shoulder_n = more * (p.shoulder_stiffness_n_m * d_m +
                                        p.shoulder_damping_n_s_m * (at.arm_m_s - at.trunk_m_s));
      const double grip_n =
          more * (p.grip_stiffness_n_m * s_m + p.grip_damping_n_s_m * (at.arm_m_s - at.stick_m_s));
      return {.trunk_n = shoulder_n, .arm_n = -shoulder_n - grip_n, .hand_n = grip_n};
    }
    case Spring::kArmRest:
      return {.arm_n = e.pad_stiffness_n_m * (rest_.position_m() - at.arm_m)};
    case Spring::kCogging:
      return {.stick_n = e.ripple_n *
                         std::sin(kTwoPi * at.stick_m / e.ripple_period_m + e.ripple_phase_rad)};
    case Spring::kDelayedReflex:
      return at_shoulder(-e.outside * late_m_);
    case Spring::kArmDrag:
      return {.arm_n = drag(e.outside, at.arm_m_s)};
    case Spring::kStickDrag:
      return {.stick_n = drag(e.outside, at.stick_m_s)};
    case Spring::kFractionalShoulder:
      return at_shoulder(-e.outside * ladder_.derivative(d_m));
    case Spring::kVibrationGrip: {
      const double h2_m2 = e.threshold_m * e.threshold_m;
      return at_grip(p.grip_stiffness_n_m * e.factor * s_m * vibration_m2_ /
                     (h2_m2 + vibration_m2_));
    }
  }
  return {};
}

void EffectOnChain::move(const ChainPlace& from, const ChainPlace& to,
                         double mean_acceleration_m_s2) noexcept {
  switch (effect_.spring) {
    case Spring::kArmRest:
      rest_.step(0.5 * (from.arm_m + to.arm_m), mean_acceleration_m_s2);
      return;
    case Spring::kDelayedReflex:
      late_m_ =
          reflex_.step(to.arm_m - to.trunk_m + kRateOverStretch_s * (to.arm_m_s - to.trunk_m_s));
      return;
    case Spring::kFractionalShoulder:
      ladder_.step(to.arm_m - to.trunk_m);
      return;
    case Spring::kVibrationGrip: {
      const double s_m = to.arm_m - to.stick_m;
      vibration_m2_ += (1.0 - keep_) * (s_m * s_m - vibration_m2_);
      return;
    }
    default:
      return;
  }
}

}  // namespace stillhand::rig
