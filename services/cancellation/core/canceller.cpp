// SPDX-License-Identifier: Apache-2.0
#include "services/cancellation/core/canceller.hpp"

#include <algorithm>
#include <cmath>

namespace stillhand::cancellation {
namespace {

const Config& checked(const Config& config) {
  validate(config, "cancellation");
  return config;
}

}  // namespace

Canceller::Canceller(const Config& config) : config_(checked(config)), envelope_(config.limits) {
  const SamplingConfig& sampling = config_.sampling;
  if (sampling.low_pass_order > 0) {
    low_pass_.emplace(static_cast<int>(sampling.low_pass_order), sampling.low_pass_hz,
                      kControlRateHz);
  }
}

void Canceller::take(const PreparedModel& model) noexcept {
  if (!model.filter.loaded()) return;
  const bool fading = incoming_.filter.loaded() && settle_left_ == 0;
  if (fading) {
    // Replacing a filter that already drives would be a step in the force.
    pending_ = model;
  } else {
    incoming_ = model;
    settle_left_ = incoming_.filter.settle_ticks();
    fade_done_ = 0;
  }
}

Refusal Canceller::load_model(const ControlModel& model) noexcept {
  const Preparation preparation = prepare(model, bounds(config_));
  if (preparation.refusal == Refusal::kNone) take(preparation.model);
  return preparation.refusal;
}

void Canceller::restart() noexcept {
  if (pending_.filter.loaded()) incoming_ = pending_;
  if (incoming_.filter.loaded()) active_ = incoming_;
  incoming_ = pending_ = PreparedModel();
  held_.fill(0.0);
  if (low_pass_) low_pass_->reset();
  engaged_ = 0;
  fade_done_ = 0;
  settle_left_ = 0;
  if (active_.filter.loaded()) {
    // From rest again: settle, then fade in from no model at all.
    incoming_ = active_;
    incoming_.filter.reset();
    incoming_.held = {};
    incoming_.adaptive.reset();
    active_ = PreparedModel();
    settle_left_ = incoming_.filter.settle_ticks();
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
    // The sample clock began again.
    if (tick < last_tick_) restart();
    last_tick_ = tick;
    return false;
  }
  // Unsigned: the distance of two 64-bit ticks always fits.
  const auto lost = static_cast<std::uint64_t>(tick) - static_cast<std::uint64_t>(last_tick_) - 1;
  const Tick before = last_tick_;
  last_tick_ = tick;
  if (lost == 0) return true;
  flags |= kInputGap;
  const auto most = static_cast<std::uint64_t>(config_.max_hold_ticks) + 1;
  const std::uint64_t bridged = std::min(lost, most);
  for (std::uint64_t i = 0; i < bridged; ++i) {
    count_absent();
    predict(held_, before + 1 + static_cast<Tick>(i));
  }
  return true;
}

const ChannelSample& Canceller::sound_sample(const CancellerInput& input, Flags& flags) noexcept {
  constexpr Flags kUnsound = kInputInvalid | kInputStale | kFault;
  constexpr auto kMain = static_cast<std::size_t>(Channel::kAccelY);
  const bool in_range =
      std::abs(input.sensed[kMain]) <= config_.max_acceleration_m_s2 &&
      std::ranges::all_of(input.sensed, [](double value) { return std::isfinite(value); });
  flags |= input.sensed_flags & kUnsound;
  if (!in_range) flags |= kInputInvalid;
  if (in_range && (input.sensed_flags & kUnsound) == 0) {
    absent_ = 0;
    for (std::size_t i = 0; i < kChannels; ++i) {
      // The bounds of check_model() hold up to here.
      const double most = i == kMain ? config_.max_acceleration_m_s2 : kChannelFacts[i].full_scale;
      held_[i] = std::clamp(input.sensed[i], -most, most);
    }
  } else {
    count_absent();
  }
  return held_;
}

Canceller::Predicted Canceller::predict(const ChannelSample& sample, Tick tick) noexcept {
  const double theta_rad = sample[static_cast<std::size_t>(Channel::kTheta)];
  // Motion of the hand while a force comes or goes is not caused by the model.
  const bool adapts = engaged_ == config_.fade_ticks && !incoming_.filter.loaded();
  ChannelSample seen = sample;
  if (low_pass_) {
    double& accel = seen[static_cast<std::size_t>(Channel::kAccelY)];
    accel = low_pass_->step(accel);
  }
  const SamplingConfig& sampling = config_.sampling;
  const bool samples = tick % sampling.model_ticks == 0;
  const auto ask = [&](PreparedModel& law) {
    if (samples) law.held.push(law.filter.step(seen, tick), sampling.latency_samples);
    const auto& force = law.held.force();
    const double against_n = law.adaptive.step(force.feedthrough_n, theta_rad, adapts);
    return Predicted{force.feedthrough_n + force.beside_n, against_n + force.beside_n};
  };
  const Predicted before = ask(active_);
  if (!incoming_.filter.loaded()) return before;
  const Predicted after = ask(incoming_);
  const double weight = static_cast<double>(fade_done_) / static_cast<double>(config_.fade_ticks);
  advance_fade();
  return {before.force_n + weight * (after.force_n - before.force_n),
          before.against_n + weight * (after.against_n - before.against_n)};
}

void Canceller::advance_fade() noexcept {
  if (settle_left_ > 0) {
    --settle_left_;
  } else if (fade_done_ < config_.fade_ticks) {
    ++fade_done_;
  } else {
    active_ = incoming_;
    incoming_ = pending_;
    pending_ = PreparedModel();
    settle_left_ = incoming_.filter.settle_ticks();
    fade_done_ = 0;
  }
}

CancellerOutput Canceller::step(const CancellerInput& input) noexcept {
  Flags flags = kGood;
  Predicted predicted;
  const bool new_sample = catch_up(input.tick, flags);
  if (new_sample) predicted = predict(sound_sample(input, flags), input.tick);
  if (!std::isfinite(predicted.force_n) || !std::isfinite(predicted.against_n)) {
    flags |= kFault;
    predicted = {};
    restart();
  }
  if (!has_model()) flags |= kNoModel;
  if (!input.permitted) flags |= kInhibited;
  const bool sound = new_sample && (flags & (kInputInvalid | kInputStale | kFault)) == 0;
  const bool acting = input.enabled && input.permitted && has_model() && sound;
  // Falls as fast as the envelope, so that one bad sample costs no more than one tick of its ramp.
  const std::int64_t fall = config_.fade_ticks / config_.limits.ramp_ticks + 1;
  engaged_ = acting ? std::min(engaged_ + 1, config_.fade_ticks)
                    : std::max<std::int64_t>(engaged_ - fall, 0);
  const double share = static_cast<double>(engaged_) / static_cast<double>(config_.fade_ticks);
  const auto limited = envelope_.step(-config_.gain * share * predicted.against_n, acting);
  return {limited.force_n, predicted.force_n, flags | limited.flags, weights()};
}

}  // namespace stillhand::cancellation
