// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "services/core/cancellation/config.hpp"
#include "services/core/cancellation/parts/prepared_model.hpp"
#include "services/core/contract/flag.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/signal/butterworth.hpp"

namespace stillhand::cancellation {

/// Feedthrough force by the session's model, METHOD Eq. CC-1 (paper III): f_hat = H a_y, and what
/// the motor should take away of it.
///
/// H may be a control model (Eq. CC-6 to CC-9) that reads further channels, and gain and phase
/// are followed where the model says so (Eq. CC-10).  H runs on every tick, or behind the stages of
/// `sampling` (Eq. CC-16).  It runs whatever the trial does, so it stays in time with the platform.
/// A lost or unsound sample holds the last acceleration (Eq. CC-2); a run longer than
/// max_hold_ticks starts the filter from rest.  A new model settles next to the old one and is
/// faded over (Eq. CC-3).
/// One thread: models come between two steps.  take() and step() neither allocate nor throw; the
/// cost of a step is bounded by max_hold_ticks + 2 filter steps.
class Force {
 public:
  struct Output {
    double predicted_n = 0.0;  ///< f_hat, + right
    double against_n = 0.0;    ///< what the motor should take away, Eq. CC-10
    Flags flags = kGood;       ///< of the sample and of the model
    bool sound = false;        ///< a new, sound sample, and a prediction that is finite
  };

  /// @param config  sound
  explicit Force(const Config& config);

  /// The model is used from the next step on: it settles next to the one in use, then is faded over
  /// (Eq. CC-3).  Copies without allocation, for the control path; prepare() made the model before,
  /// in another thread.  Nothing happens where the model is empty.
  void take(const PreparedModel& model) noexcept;

  /// Gain and phase are followed so from now on, whatever the models say; none: as they say.
  /// Weights begin at 1 and 0.  Only while nothing acts against this force.
  void follow(const std::optional<AdaptiveGain>& fresh) noexcept;

  /// True once a model was taken, even while it still settles.
  [[nodiscard]] bool has_model() const noexcept { return newest().filter.loaded(); }

  /// One sample.
  /// @param in_effect  the motor's force is in full effect: only then gain and phase are followed
  Output step(Tick tick, const ChannelSample& sensed, Flags sensed_flags, bool in_effect) noexcept;

  /// Gain and phase followed, Eq. CC-10; 1 and 0 for a model that doesn't adapt.
  [[nodiscard]] const AdaptiveGain::Pair& weights() const noexcept {
    return newest().adaptive.weights();
  }
  /// Until the first model has settled and is faded in [ticks]; 0 while one acts, or without any.
  [[nodiscard]] std::int64_t unsettled_ticks() const noexcept {
    const bool first = incoming_.filter.loaded() && !active_.filter.loaded();
    return first ? settle_left_ + config_.fade_ticks - fade_done_ : 0;
  }
  /// Of the newest model; 0 without one.
  [[nodiscard]] std::int64_t settle_ticks() const noexcept {
    return newest().filter.settle_ticks();
  }

 private:
  [[nodiscard]] const PreparedModel& newest() const noexcept {
    return incoming_.filter.loaded() ? incoming_ : active_;
  }
  /// Begins to follow gain and phase.
  void begin(PreparedModel& model) const noexcept {
    if (model.filter.loaded()) model.adaptive = follow_ ? *follow_ : model.own;
  }
  /// Forgets all motion, as at the start; the newest model stays.
  void restart() noexcept;
  /// Brings the filters to the tick before `tick`; false when that tick is not a new one.
  bool catch_up(Tick tick, bool in_effect, Flags& flags) noexcept;
  /// What to use at this tick: the sample, or the one held.
  const ChannelSample& sound_sample(const ChannelSample& sensed, Flags sensed_flags,
                                    Flags& flags) noexcept;
  /// One more tick without a sound sample.
  void count_absent() noexcept;
  /// Prediction of one tick, Eq. CC-3.
  Output predict(const ChannelSample& sample, Tick tick, bool in_effect) noexcept;
  /// Takes the step from settling to fading to done.
  void advance_fade() noexcept;

  Config config_;
  std::optional<signal::Butterworth> low_pass_;
  std::optional<AdaptiveGain> follow_;  ///< as at its start
  PreparedModel active_;
  PreparedModel incoming_;  ///< settles, then is faded in
  PreparedModel pending_;   ///< came while another was fading in
  std::int64_t settle_left_ = 0;
  std::int64_t fade_done_ = 0;
  std::int64_t absent_ = 0;  ///< ticks since the last sound sample
  ChannelSample held_{};
  Tick last_tick_ = 0;
  bool started_ = false;
};

}  // namespace stillhand::cancellation
