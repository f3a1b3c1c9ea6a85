// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/parts/force.hpp"

#include <algorithm>
#include <cmath>

namespace stillhand::cancellation {

Force::Force(const Config& config) : config_(config) {
  const SamplingConfig& sampling = config_.sampling;
  if (sampling.low_pass_order > 0) {
    low_pass_.emplace(static_cast<int>(sampling.low_pass_order), sampling.low_pass_hz,
                      kControlRateHz);
  }
}

void Force::take(const PreparedModel& model) noexcept {
  if (!model.filter.loaded()) return;
  const bool fading = incoming_.filter.loaded() && settle_left_ == 0;
  if (fading) {
    // Replacing a filter that already drives would be a step in the force.
    pending_ = model;
    begin(pending_);
  } else {
    incoming_ = model;
    begin(incoming_);
    settle_left_ = incoming_.filter.settle_ticks();
    fade_done_ = 0;
  }
}

void Force::follow(const std::optional<AdaptiveGain>& fresh) noexcept {
  follow_ = fresh;
  begin(active_);
  begin(incoming_);
  begin(pending_);
}

void Force::restart() noexcept {
  if (pending_.filter.loaded()) incoming_ = pending_;
  if (incoming_.filter.loaded()) active_ = incoming_;
  incoming_ = pending_ = PreparedModel();
  held_.fill(0.0);
  if (low_pass_) low_pass_->reset();
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

void Force::count_absent() noexcept {
  if (absent_ <= config_.max_hold_ticks) ++absent_;
  // In every further tick, too: the model settles from the sample with which they come back.
  if (absent_ == config_.max_hold_ticks + 1) restart();
}

bool Force::catch_up(Tick tick, bool in_effect, Flags& flags) noexcept {
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
    predict(held_, before + 1 + static_cast<Tick>(i), in_effect);
  }
  return true;
}

const ChannelSample& Force::sound_sample(const ChannelSample& sensed, Flags sensed_flags,
                                         Flags& flags) noexcept {
  constexpr Flags kUnsound = kInputInvalid | kInputStale | kFault;
  constexpr auto kMain = static_cast<std::size_t>(Channel::kAccelY);
  const bool in_range =
      std::abs(sensed[kMain]) <= config_.max_acceleration_m_s2 &&
      std::ranges::all_of(sensed, [](double value) { return std::isfinite(value); });
  flags |= sensed_flags & kUnsound;
  if (!in_range) flags |= kInputInvalid;
  if (in_range && (sensed_flags & kUnsound) == 0) {
    absent_ = 0;
    for (std::size_t i = 0; i < kChannels; ++i) {
      // The bounds of check_model() hold up to here.
      const double most = i == kMain ? config_.max_acceleration_m_s2 : kChannelFacts[i].full_scale;
      held_[i] = std::clamp(sensed[i], -most, most);
    }
  } else {
    count_absent();
  }
  return held_;
}

Force::Output Force::predict(const ChannelSample& sample, Tick tick, bool in_effect) noexcept {
  const double theta_rad = sample[static_cast<std::size_t>(Channel::kTheta)];
  // Motion of the hand while a force comes or goes is not caused by the model.
  const bool adapts = in_effect && !incoming_.filter.loaded();
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
    return Output{force.feedthrough_n + force.beside_n, against_n + force.beside_n};
  };
  const Output before = ask(active_);
  if (!incoming_.filter.loaded()) return before;
  const Output after = ask(incoming_);
  const double weight = static_cast<double>(fade_done_) / static_cast<double>(config_.fade_ticks);
  advance_fade();
  return {before.predicted_n + weight * (after.predicted_n - before.predicted_n),
          before.against_n + weight * (after.against_n - before.against_n)};
}

void Force::advance_fade() noexcept {
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

Force::Output Force::step(Tick tick, const ChannelSample& sensed, Flags sensed_flags,
                          bool in_effect) noexcept {
  Flags flags = kGood;
  Output out;
  const bool new_sample = catch_up(tick, in_effect, flags);
  if (new_sample) out = predict(sound_sample(sensed, sensed_flags, flags), tick, in_effect);
  if (!std::isfinite(out.predicted_n) || !std::isfinite(out.against_n)) {
    flags |= kFault;
    out = {};
    restart();
  }
  if (!has_model()) flags |= kNoModel;
  out.flags = flags;
  out.sound = new_sample && (flags & (kInputInvalid | kInputStale | kFault)) == 0;
  return out;
}

}  // namespace stillhand::cancellation
