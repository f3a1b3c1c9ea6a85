// SPDX-License-Identifier: Apache-2.0
#include "cancellation/core/canceller.hpp"

#include <algorithm>
#include <cmath>

namespace stillhand::cancellation {
namespace {

const Config& checked(const Config& config) {
  validate(config, "cancellation");
  return config;
}

}  // namespace

Canceller::Canceller(const Config& config) : config_(checked(config)), envelope_(config.limits) {}

Refusal Canceller::load_model(const ControlRateModel& model) noexcept {
  const ModelCheck check = check_model(model, config_.max_model_gain_n_s2_m);
  if (check.refusal != Refusal::kNone) return check.refusal;
  const ModelFilter filter(model, check.settle_ticks);
  const bool fading = incoming_.loaded() && settle_left_ == 0;
  if (fading) {
    // Replacing a filter that already drives would be a step in the force.
    pending_ = filter;
  } else {
    incoming_ = filter;
    settle_left_ = filter.settle_ticks();
    fade_done_ = 0;
  }
  return Refusal::kNone;
}

void Canceller::restart() noexcept {
  if (pending_.loaded()) incoming_ = pending_;
  if (incoming_.loaded()) active_ = incoming_;
  incoming_ = pending_ = ModelFilter();
  held_m_s2_ = 0.0;
  engaged_ = 0;
  fade_done_ = 0;
  settle_left_ = 0;
  if (active_.loaded()) {
    // From rest again: settle, then fade in from no model at all.
    incoming_ = active_;
    incoming_.reset();
    active_ = ModelFilter();
    settle_left_ = incoming_.settle_ticks();
  }
}

void Canceller::count_absent() noexcept {
  if (absent_ <= config_.max_hold_ticks) ++absent_;
  if (absent_ == config_.max_hold_ticks + 1) restart();
}

bool Canceller::catch_up(Tick tick, Flags& flags) noexcept {
  if (!started_) {
    started_ = true;
    last_tick_ = tick;
    return true;
  }
  if (tick <= last_tick_) {
    flags |= kInputInvalid;
    // The sample clock began anew.
    if (tick < last_tick_) restart();
    last_tick_ = tick;
    return false;
  }
  // Unsigned: the distance of two 64-bit ticks always fits.
  const auto lost = static_cast<std::uint64_t>(tick) - static_cast<std::uint64_t>(last_tick_) - 1;
  last_tick_ = tick;
  if (lost == 0) return true;
  flags |= kInputGap;
  const auto most = static_cast<std::uint64_t>(config_.max_hold_ticks) + 1;
  const std::uint64_t bridged = std::min(lost, most);
  for (std::uint64_t i = 0; i < bridged; ++i) {
    count_absent();
    predict(held_m_s2_);
  }
  return true;
}

double Canceller::sound_acceleration(const CancellerInput& input, Flags& flags) noexcept {
  constexpr Flags kUnsound = kInputInvalid | kInputStale | kFault;
  const bool in_range = std::abs(input.accel_y_m_s2) <= config_.max_acceleration_m_s2;
  flags |= input.sensed_flags & kUnsound;
  if (!in_range) flags |= kInputInvalid;
  if (in_range && (input.sensed_flags & kUnsound) == 0) {
    absent_ = 0;
    held_m_s2_ = input.accel_y_m_s2;
  } else {
    count_absent();
  }
  return held_m_s2_;
}

double Canceller::predict(double accel_m_s2) noexcept {
  const double before_n = active_.step(accel_m_s2);
  if (!incoming_.loaded()) return before_n;
  const double after_n = incoming_.step(accel_m_s2);
  const double weight = static_cast<double>(fade_done_) / static_cast<double>(config_.fade_ticks);
  advance_fade();
  return before_n + weight * (after_n - before_n);
}

void Canceller::advance_fade() noexcept {
  if (settle_left_ > 0) {
    --settle_left_;
  } else if (fade_done_ < config_.fade_ticks) {
    ++fade_done_;
  } else {
    active_ = incoming_;
    incoming_ = pending_;
    pending_ = ModelFilter();
    settle_left_ = incoming_.settle_ticks();
    fade_done_ = 0;
  }
}

CancellerOutput Canceller::step(const CancellerInput& input) noexcept {
  Flags flags = kGood;
  double predicted_n = 0.0;
  const bool new_sample = catch_up(input.tick, flags);
  if (new_sample) predicted_n = predict(sound_acceleration(input, flags));
  if (!std::isfinite(predicted_n)) {
    flags |= kFault;
    predicted_n = 0.0;
    restart();
  }
  const bool has_model = active_.loaded() || incoming_.loaded();
  if (!has_model) flags |= kNoModel;
  if (!input.permitted) flags |= kInhibited;
  const bool sound = new_sample && (flags & (kInputInvalid | kInputStale | kFault)) == 0;
  const bool acting = input.enabled && input.permitted && has_model && sound;
  // Falls as fast as the envelope, so that one bad sample costs no more than one tick of its ramp.
  const std::int64_t fall = config_.fade_ticks / config_.limits.ramp_ticks + 1;
  engaged_ = acting ? std::min(engaged_ + 1, config_.fade_ticks)
                    : std::max<std::int64_t>(engaged_ - fall, 0);
  const double share = static_cast<double>(engaged_) / static_cast<double>(config_.fade_ticks);
  const auto limited = envelope_.step(-config_.gain * share * predicted_n, acting);
  return {limited.force_n, predicted_n, flags | limited.flags};
}

}  // namespace stillhand::cancellation
