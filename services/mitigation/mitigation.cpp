// SPDX-License-Identifier: Apache-2.0
#include "services/mitigation/mitigation.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "services/contract/config_error.hpp"

namespace stillhand::mitigation {
namespace {

using cancellation::Channel;

double of(const cancellation::ChannelSample& sample, Channel channel) {
  return sample[static_cast<std::size_t>(channel)];
}

// Within the sensor's range: the parts stay finite.
double within(const cancellation::ChannelSample& sample, Channel channel) {
  const auto i = static_cast<std::size_t>(channel);
  const double most = cancellation::kChannelFacts[i].full_scale;
  return std::clamp(sample[i], -most, most);
}

}  // namespace

Mitigation::Mitigation(const Recipe& recipe)
    : canceller_(recipe.canceller),
      envelope_(recipe.canceller.limits),
      lever_m_(recipe.lever_m),
      max_acceleration_m_s2_(recipe.canceller.max_acceleration_m_s2),
      fade_ticks_(recipe.canceller.fade_ticks),
      fall_(recipe.canceller.fade_ticks / recipe.canceller.limits.ramp_ticks + 1) {
  if (!(lever_m_ > 0.0)) {
    throw ConfigError("mitigation.lever_m", std::to_string(lever_m_), "above 0");
  }
  if (recipe.force) {
    const cancellation::Preparation made = prepare(*recipe.force, bounds(recipe.canceller));
    if (made.refusal != cancellation::Refusal::kNone) {
      throw ConfigError("mitigation.force", std::string(cancellation::describe(made.refusal)),
                        "a model that the canceller accepts");
    }
    canceller_.take(made.model);
    settle_ticks_ = made.model.filter.settle_ticks();
  }
  if (recipe.schedule) schedule_.emplace(*recipe.schedule);
  if (recipe.impedance) impedance_.emplace(*recipe.impedance);
  if (recipe.lms_force) lms_force_.emplace(*recipe.lms_force);
  if (recipe.signal) {
    signal_.emplace(recipe.signal->feedthrough_to_position);
    settle_ticks_ =
        std::max(settle_ticks_, cancellation::settle_ticks(recipe.signal->feedthrough_to_position));
    if (recipe.signal->moved_by_motor) {
      moved_by_motor_.emplace(*recipe.signal->moved_by_motor, recipe.signal->stick);
    }
  }
  if (recipe.predicted_signal) predicted_signal_.emplace(*recipe.predicted_signal);
  if (recipe.lms_signal) lms_signal_.emplace(*recipe.lms_signal);
  if (recipe.shaping) shaping_.emplace(*recipe.shaping);
}

bool Mitigation::sound(const cancellation::CancellerInput& input) noexcept {
  constexpr Flags kUnsound = kInputInvalid | kInputStale | kFault;
  const bool newer = input.tick > last_tick_;
  last_tick_ = input.tick;
  return newer && (input.sensed_flags & kUnsound) == 0 &&
         std::abs(of(input.sensed, Channel::kAccelY)) <= max_acceleration_m_s2_ &&
         std::ranges::all_of(input.sensed, [](double value) { return std::isfinite(value); });
}

double Mitigation::forces(double accel_m_s2, double theta_rad, double omega_rad_s) noexcept {
  double wanted_n = 0.0;
  if (schedule_) wanted_n -= schedule_->step(accel_m_s2, theta_rad, force_n_);
  if (impedance_) wanted_n += impedance_->step(theta_rad, omega_rad_s);
  if (lms_force_) wanted_n -= lms_force_->output(accel_m_s2);
  return wanted_n;
}

double Mitigation::moved(double accel_m_s2, double theta_rad, double predicted_n) noexcept {
  double moved_m = 0.0;
  if (signal_) moved_m += signal_->step(accel_m_s2);
  if (moved_by_motor_) moved_m += moved_by_motor_->step(0.0, force_n_).displacement_m;
  if (predicted_signal_) {
    moved_m += lever_m_ * (theta_rad - predicted_signal_->step(theta_rad, predicted_n));
  }
  lms_moved_m_ = lms_signal_ ? lms_signal_->output(accel_m_s2) : 0.0;
  return moved_m + lms_moved_m_;
}

double Mitigation::off(double accel_m_s2, double theta_rad, double predicted_n) noexcept {
  const double moved_rad = moved(accel_m_s2, theta_rad, predicted_n) / lever_m_;
  return shaping_ ? theta_rad - shaping_->step(theta_rad - moved_rad) : moved_rad;
}

void Mitigation::learn(double theta_rad, bool learns) noexcept {
  const double x_m = lever_m_ * theta_rad;
  if (lms_force_) lms_force_->learn(x_m, learns);
  if (lms_signal_) lms_signal_->learn(x_m - lms_moved_m_, learns);
}

MitigationOutput Mitigation::step(const cancellation::CancellerInput& input) noexcept {
  cancellation::CancellerInput asked = input;
  asked.enabled = input.enabled && !predicted_signal_;
  const cancellation::CancellerOutput cancelled = canceller_.step(asked);
  const bool good = sound(input);
  const bool acting = input.enabled && input.permitted && good && finite_;
  engaged_ =
      acting ? std::min(engaged_ + 1, fade_ticks_) : std::max<std::int64_t>(engaged_ - fall_, 0);
  const double share = static_cast<double>(engaged_) / static_cast<double>(fade_ticks_);
  double wanted_n = cancelled.force_n;
  if (good) {
    const double accel_m_s2 = of(input.sensed, Channel::kAccelY);
    const double theta_rad = within(input.sensed, Channel::kTheta);
    wanted_n += share * forces(accel_m_s2, theta_rad, within(input.sensed, Channel::kOmega));
    const double off_rad = off(accel_m_s2, theta_rad, cancelled.predicted_force_n);
    finite_ = std::isfinite(off_rad);
    if (finite_) off_rad_ = off_rad;
    learn(theta_rad, acting && engaged_ == fade_ticks_);
  } else if (shaping_ && engaged_ == 0) {
    shaping_->restart();  // what it knows of the stick is old
  }
  const double stick_rad = of(input.sensed, Channel::kTheta);
  if (std::isfinite(stick_rad)) theta_rad_ = stick_rad;
  const double taken_off_rad = share * off_rad_;
  const auto limited = envelope_.step(wanted_n, acting);
  force_n_ = limited.force_n;
  return {limited.force_n, theta_rad_ - taken_off_rad, taken_off_rad,
          cancelled.flags | limited.flags, cancelled.weights};
}

}  // namespace stillhand::mitigation
