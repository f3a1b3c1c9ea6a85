// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "services/cancellation/core/prepared_model.hpp"
#include "services/contract/config_field.hpp"
#include "services/contract/flag.hpp"
#include "services/contract/tick.hpp"
#include "services/signal/butterworth.hpp"
#include "services/signal/force_envelope.hpp"

namespace stillhand::cancellation {

struct CancellerInput {
  Tick tick;             ///< of the sensed sample
  ChannelSample sensed;  ///< platform and stick; indexed by Channel
  Flags sensed_flags;    ///< of the sensed sample
  bool enabled;          ///< the trial asks for cancellation
  bool permitted;        ///< interlock closed
};
struct CancellerOutput {
  double force_n;            ///< [N] motor force wanted at the hand, + right, after limits
  double predicted_force_n;  ///< [N] f_hat, + right
  Flags flags;
  AdaptiveGain::Pair weights;  ///< w_0, w_1 [-], Eq. CC-10
};

struct Config {
  signal::ForceLimits limits;
  SamplingConfig sampling;
  double gain = 1.0;
  double max_model_gain_n_s2_m = 60.0;
  double max_path_force_n = 25.0;
  double max_acceleration_m_s2 = 60.0;
  std::int64_t fade_ticks = 250;
  std::int64_t max_hold_ticks = 50;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit.group("limits", self.limits);
    visit.group("sampling", self.sampling);
    visit("gain", self.gain, Range{0.0, 1.2}, "[-] share of the predicted force that is cancelled");
    visit("max_model_gain_n_s2_m", self.max_model_gain_n_s2_m, Range{1.0, 200.0},
          "[N s^2/m] largest |H| of a model, any frequency; paper IV-A: 3.2 at 0 Hz");
    visit("max_path_force_n", self.max_path_force_n, Range{0.0, 60.0},
          "[N] most that a model may ask for from the stick at its full scale, or from a tone");
    visit("max_acceleration_m_s2", self.max_acceleration_m_s2, Range{1.0, 500.0},
          "[m/s^2] a larger magnitude is no platform motion (paper III-C: peak 7.5) but a fault");
    visit("fade_ticks", self.fade_ticks, Range{50.0, 5000.0},
          "[ticks] fade from zero or from the model before, after the new one has settled");
    visit(
        "max_hold_ticks", self.max_hold_ticks, Range{1.0, 200.0},
        "[ticks] longest run of missing samples bridged by holding the last; then start from rest");
  }
};

/// What these settings let a model ask for.
inline ModelBounds bounds(const Config& config) noexcept {
  return {config.max_model_gain_n_s2_m, config.max_path_force_n, config.sampling.model_ticks};
}

/// Cancels biodynamic feedthrough, METHOD Eq. CC-1 (paper III: the motor acts against f_hat):
///
///   f_hat = H a_y,   wanted = -gain f_hat,   force = ForceEnvelope(wanted)   (Eq. SG-6)
///
/// H may be a control model (Eq. CC-6 to CC-9) that reads further channels, and gain and phase
/// are followed where the model says so (Eq. CC-10).  H runs on every tick, or behind the stages of
/// `sampling` (Eq. CC-16).
/// The force leaves zero only while enabled, permitted, with a model and a sound sample.  A lost or
/// unsound sample holds the last acceleration (Eq. CC-2); a run longer than max_hold_ticks starts
/// the filter from rest.  After an interruption the force fades in again; a new model settles next
/// to the old one and is faded over (Eq. CC-3).
/// One thread: models come between two steps.  take() and step() neither allocate nor throw; the
/// cost of a step is bounded by max_hold_ticks + 2 filter steps.
class Canceller {
 public:
  /// @throws stillhand::ConfigError when a setting is outside its range.
  explicit Canceller(const Config& config);

  /// The model is used from the next step on: it settles next to the one in use, then is faded over
  /// (Eq. CC-3).  Copies without allocation, for the control path; prepare() made the model before,
  /// in another thread.  Nothing happens where the model is empty.
  void take(const PreparedModel& model) noexcept;
  /// prepare() and take() at once, where no deadline waits: in one process, in tests.
  Refusal load_model(const ControlModel& model) noexcept;

  /// True once a model was taken, even while it still settles.
  [[nodiscard]] bool has_model() const noexcept {
    return active_.filter.loaded() || incoming_.filter.loaded();
  }

  CancellerOutput step(const CancellerInput& input) noexcept;

  /// Gain and phase followed, Eq. CC-10; 1 and 0 for a model that doesn't adapt.
  [[nodiscard]] const AdaptiveGain::Pair& weights() const noexcept {
    return (incoming_.filter.loaded() ? incoming_ : active_).adaptive.weights();
  }

 private:
  struct Predicted {
    double force_n = 0.0;    ///< f_hat
    double against_n = 0.0;  ///< what the motor should take away, Eq. CC-10
  };

  /// Forgets all motion, as at the start; the newest model stays.
  void restart() noexcept;
  /// Brings the filters to the tick before `tick`; false when that tick is not a new one.
  bool catch_up(Tick tick, Flags& flags) noexcept;
  /// What to use at this tick: the sample, or the one held.
  const ChannelSample& sound_sample(const CancellerInput& input, Flags& flags) noexcept;
  /// One more tick without a sound sample.
  void count_absent() noexcept;
  /// Prediction of one tick, Eq. CC-3.
  Predicted predict(const ChannelSample& sample, Tick tick) noexcept;
  /// Takes the step from settling to fading to done.
  void advance_fade() noexcept;

  Config config_;
  signal::ForceEnvelope envelope_;
  std::optional<signal::Butterworth> low_pass_;
  PreparedModel active_;
  PreparedModel incoming_;  ///< settles, then is faded in
  PreparedModel pending_;   ///< came while another was fading in
  std::int64_t settle_left_ = 0;
  std::int64_t fade_done_ = 0;
  std::int64_t engaged_ = 0;  ///< ticks that the force has been acting, up to fade_ticks
  std::int64_t absent_ = 0;   ///< ticks since the last sound sample
  ChannelSample held_{};
  Tick last_tick_ = 0;
  bool started_ = false;
};

}  // namespace stillhand::cancellation
