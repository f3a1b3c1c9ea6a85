// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/parts/part_list.hpp"

#include <string>

#include "services/core/cancellation/model_check.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::cancellation {

PartList::PartList(const Recipe& recipe) : force_(recipe.force), lever_m_(recipe.lever_m) {
  if (!(lever_m_ > 0.0)) {
    throw ConfigError("mitigation.lever_m", std::to_string(lever_m_), "above 0");
  }
  if (recipe.follow) {
    if (!is_hand(*recipe.follow)) {
      throw ConfigError("mitigation.follow", std::string(describe(Refusal::kCompliance)),
                        "a hand of a person");
    }
    follow_.emplace(*recipe.follow);
  }
  if (recipe.perturbation) perturbation_.emplace(*recipe.perturbation);
  if (recipe.schedule) schedule_.emplace(*recipe.schedule);
  if (recipe.impedance) impedance_.emplace(*recipe.impedance);
  if (recipe.lms_force) lms_force_.emplace(*recipe.lms_force);
  if (recipe.signal) {
    const signal::DifferenceModel& model = recipe.signal->feedthrough_to_position;
    if (!signal::well_formed(model) || !signal::is_stable(model) ||
        model.order() > ControlModelFilter::kMaxOrder || model.rate_hz != kControlRateHz) {
      throw ConfigError("mitigation.signal", "a model that is none", "a stable one at 1000 Hz");
    }
    settle_ticks_ = cancellation::settle_ticks(model);
    signal_.emplace(control_model(model), settle_ticks_);
    if (recipe.signal->moved_by_motor) {
      moved_by_motor_.emplace(*recipe.signal->moved_by_motor, recipe.signal->stick);
    }
  }
  if (recipe.predicted_signal) predicted_signal_.emplace(*recipe.predicted_signal);
  if (recipe.lms_signal) lms_signal_.emplace(*recipe.lms_signal);
  if (recipe.shaping) shaping_.emplace(*recipe.shaping);
}

double PartList::forces(const Moment& now) noexcept {
  double wanted_n = 0.0;
  if (perturbation_) wanted_n += perturbation_->force_n(now.tick, now.trial);
  if (schedule_) wanted_n -= schedule_->step(now.accel_m_s2, now.theta_rad, now.motor_n);
  if (impedance_) wanted_n += impedance_->step(now.theta_rad, now.omega_rad_s);
  if (lms_force_) wanted_n -= lms_force_->output(now.accel_m_s2);
  return wanted_n;
}

double PartList::moved(const Moment& now) noexcept {
  double moved_m = 0.0;
  if (signal_) {
    ChannelSample sample{};
    sample[static_cast<std::size_t>(Channel::kAccelY)] = now.accel_m_s2;
    moved_m += signal_->step(sample, now.tick).feedthrough_n;
  }
  if (moved_by_motor_) moved_m += moved_by_motor_->step(0.0, now.motor_n).displacement_m;
  if (predicted_signal_) {
    moved_m += lever_m_ * (now.theta_rad - predicted_signal_->step(now.theta_rad, now.predicted_n));
  }
  lms_moved_m_ = lms_signal_ ? lms_signal_->output(now.accel_m_s2) : 0.0;
  return moved_m + lms_moved_m_;
}

double PartList::off(const Moment& now) noexcept {
  const double moved_rad = moved(now) / lever_m_;
  return shaping_ ? now.theta_rad - shaping_->step(now.theta_rad - moved_rad) : moved_rad;
}

void PartList::learn(double theta_rad, bool learns) noexcept {
  const double x_m = lever_m_ * theta_rad;
  if (lms_force_) lms_force_->learn(x_m, learns);
  if (lms_signal_) lms_signal_->learn(x_m - lms_moved_m_, learns);
}

}  // namespace stillhand::cancellation
