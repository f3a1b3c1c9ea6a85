// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/parts/part_list.hpp"

#include <algorithm>
#include <functional>
#include <string>

#include "services/core/cancellation/model_check.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::cancellation {

PartList::PartList(const Recipe& recipe)
    : force_(recipe.force),
      needs_force_(recipe.force || cancellation::needs_force(recipe.parts)),
      lever_m_(recipe.lever_m) {
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
  std::vector<Part> parts = recipe.parts;
  std::ranges::stable_sort(parts, std::less(), &Part::kind);
  for (const Part& part : parts) add(part);
}

void PartList::add(const Part& part) {
  const PartRow* const row = row_of(part.kind);
  if (row == nullptr || row->make == nullptr) {
    throw ConfigError(key_of(part), "no part of its values alone", "a row of kPartRows with one");
  }
  if (row->filters_command) filter_ = steps_.size();
  steps_.emplace_back(row->make(part));
}

double PartList::forces(const Moment& now) noexcept {
  double wanted_n = 0.0;
  if (perturbation_) wanted_n += perturbation_->force_n(now.tick, now.trial);
  if (schedule_) wanted_n -= schedule_->step(now.accel_m_s2, now.theta_rad, now.motor_n);
  for (const OwnedStep& step : steps_) wanted_n += step->force_n(now);
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
  for (const OwnedStep& step : steps_) moved_m += step->moved_m(now, lever_m_);
  return moved_m;
}

double PartList::off(const Moment& now) noexcept {
  const double moved_rad = moved(now) / lever_m_;
  if (!filter_) return moved_rad;
  return now.theta_rad - steps_[*filter_]->filtered_rad(now.theta_rad - moved_rad);
}

void PartList::learn(double theta_rad, bool learns) noexcept {
  const double x_m = lever_m_ * theta_rad;
  for (const OwnedStep& step : steps_) step->learn(x_m, learns);
}

}  // namespace stillhand::cancellation
