// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/parts/countermeasure.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "services/core/cancellation/model_check.hpp"

namespace stillhand::cancellation {
namespace {

const Config& checked(const Config& config) {
  validate(config, "cancellation");
  return config;
}

double of(const ChannelSample& sample, Channel channel) {
  return sample[static_cast<std::size_t>(channel)];
}

// Within the sensor's range: the parts stay finite.
double within(const ChannelSample& sample, Channel channel) {
  const double most = kChannelFacts[static_cast<std::size_t>(channel)].full_scale;
  return std::clamp(of(sample, channel), -most, most);
}

}  // namespace

Countermeasure::Countermeasure(const Config& config, const Recipe& recipe)
    : config_(checked(config)),
      envelope_(config.limits),
      force_(config),
      own_(recipe),
      follows_(own_.follow()) {
  if (follows_) force_.follow(own_.follow());
  if (!recipe.model) return;
  require_taken(load_model(*recipe.model), "mitigation.force",
                "a model that the canceller accepts");
}

Refusal Countermeasure::load_model(const ControlModel& model) noexcept {
  const Preparation preparation = prepare(model, bounds(config_));
  if (preparation.refusal == Refusal::kNone) take(preparation.model);
  return preparation.refusal;
}

void Countermeasure::use(PartList& parts) noexcept {
  if (follows_ || parts.follow()) force_.follow(parts.follow());
  follows_ = parts.follow().has_value();
  lent_ = &parts;
  off_rad_ = 0.0;
  finite_ = true;
}

std::int64_t Countermeasure::settle_ticks() const noexcept {
  return std::max(force_.settle_ticks(), running().settle_ticks());
}

CountermeasureOutput Countermeasure::step(const CountermeasureInput& input) noexcept {
  PartList& parts = running();
  const std::int64_t full = config_.fade_ticks;
  // Where the motor does not act against f^, what is left of it says nothing about the model.
  const bool in_effect = engaged_ == full && parts.acts_against_force();
  const Force::Output force = force_.step(input.tick, input.sensed, input.sensed_flags, in_effect);
  const bool acting = input.enabled && input.permitted && force.sound && finite_ &&
                      (has_model() || !parts.needs_force());
  // Falls as fast as the envelope, so that one bad sample costs no more than one tick of its ramp.
  const std::int64_t fall = full / config_.limits.ramp_ticks + 1;
  engaged_ = acting ? std::min(engaged_ + 1, full) : std::max<std::int64_t>(engaged_ - fall, 0);
  const double share = static_cast<double>(engaged_) / static_cast<double>(full);
  double wanted_n = parts.acts_against_force() ? -config_.gain * share * force.against_n : 0.0;
  if (force.sound) {
    const Moment now{of(input.sensed, Channel::kAccelY),
                     within(input.sensed, Channel::kTheta),
                     within(input.sensed, Channel::kOmega),
                     force.predicted_n,
                     force_n_,
                     input.tick,
                     input.trial};
    const double parts_n = parts.forces(now);
    wanted_n += share * parts_n;
    const double off_rad = parts.off(now);
    if (std::isfinite(off_rad)) off_rad_ = off_rad;
    finite_ = std::isfinite(off_rad) && std::isfinite(parts_n);
    parts.learn(now.theta_rad, acting && engaged_ == full);
  } else if (engaged_ == 0) {
    parts.restart();
  }
  const double stick_rad = of(input.sensed, Channel::kTheta);
  if (std::isfinite(stick_rad)) theta_rad_ = stick_rad;
  const double taken_off_rad = share * off_rad_;
  const auto limited = envelope_.step(wanted_n, acting);
  force_n_ = limited.force_n;
  const Flags inhibited = input.permitted ? kGood : kInhibited;
  return {limited.force_n, force.predicted_n,          force.flags | inhibited | limited.flags,
          weights(),       theta_rad_ - taken_off_rad, taken_off_rad};
}

}  // namespace stillhand::cancellation
