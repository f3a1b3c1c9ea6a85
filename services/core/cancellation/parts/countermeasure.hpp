// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/core/cancellation/parts/force.hpp"
#include "services/core/cancellation/parts/part_list.hpp"
#include "services/core/contract/trial.hpp"
#include "services/core/signal/force_envelope.hpp"

namespace stillhand::cancellation {

struct CountermeasureInput {
  Tick tick;             ///< of the sensed sample
  ChannelSample sensed;  ///< platform and stick; indexed by Channel
  Flags sensed_flags;    ///< of the sensed sample
  bool enabled;          ///< the trial asks for what the parts do
  bool permitted;        ///< interlock closed
  Trial trial = {};      ///< the newest, for a perturbation
};
struct CountermeasureOutput {
  double force_n;            ///< [N] motor force wanted at the hand, + right, after limits
  double predicted_force_n;  ///< [N] f_hat, + right, whether or not it is cancelled
  Flags flags;
  AdaptiveGain::Pair weights;  ///< w_0, w_1 [-], Eq. CC-10
  double command_rad = 0.0;    ///< for the machine, in place of the stick's angle; always finite
  double taken_off_rad = 0.0;  ///< off the stick's angle; exactly 0 without a part on the command
};

/// What is done about feedthrough in a trial: a list of parts behind one share and one envelope,
/// METHOD Eq. CC-1 and MI-6:
///
///   wanted = e (-gain f^ - f^_schedule + impedance - y_lms + perturbation)
///   force = ForceEnvelope(wanted)                                             (Eq. SG-6)
///   command = theta - e (theta - shaping(theta - (G a + P force + y_lms + CC-5) / lever))
///
/// e rises from 0 to 1 over fade_ticks while the parts may act, so force and command are continuous
/// wherever a part begins or ends.  They may act while enabled, permitted, with a new and sound
/// sample, with a model where a part needs f^, and while what they ask for is finite.  The force is
/// zero within ramp_ticks otherwise, whatever the parts ask for.  A tick without a sound sample
/// does not step the parts, while f^ is bridged (CC-2); what they take off the command is held
/// while e falls, so it is zero within ramp_ticks too.  One thread; a copy goes on on its own, with
/// the parts lent to it.  step(), take() and use() never allocate, lock or throw.
class Countermeasure {
 public:
  /// @param recipe  parts of its own; without any, B
  /// @throws stillhand::ConfigError when a setting is outside its range, or a part or its model is
  ///         refused.
  explicit Countermeasure(const Config& config, const Recipe& recipe = {});

  /// The session's model of f^ from the next step on, Force::take().
  void take(const PreparedModel& model) noexcept { force_.take(model); }
  /// prepare() and take() at once, where no deadline waits: in one process, in tests.
  Refusal load_model(const ControlModel& model) noexcept;
  [[nodiscard]] bool has_model() const noexcept { return force_.has_model(); }
  /// Until f^ is that of a model in full effect [ticks], Force::unsettled_ticks().
  [[nodiscard]] std::int64_t unsettled_ticks() const noexcept { return force_.unsettled_ticks(); }

  /// Other parts from the next step on; only while it does not act.  Those of before may be gone.
  /// @param parts  outlives its use
  void use(PartList& parts) noexcept;
  [[nodiscard]] bool runs(const PartList& parts) const noexcept { return lent_ == &parts; }
  /// A force or a share of one is left, or something is taken off.
  [[nodiscard]] bool acts() const noexcept { return engaged_ > 0 || force_n_ != 0.0; }

  CountermeasureOutput step(const CountermeasureInput& input) noexcept;

  /// Gain and phase followed, Eq. CC-10; 1 and 0 where nothing follows.
  [[nodiscard]] const AdaptiveGain::Pair& weights() const noexcept { return force_.weights(); }
  /// w of Eq. MI-5; 0 without a schedule.
  [[nodiscard]] double schedule_weight() const noexcept { return running().schedule_weight(); }
  /// From the first step until the models of force and position have settled [ticks], CC-4.
  [[nodiscard]] std::int64_t settle_ticks() const noexcept;

 private:
  [[nodiscard]] PartList& running() noexcept { return lent_ != nullptr ? *lent_ : own_; }
  [[nodiscard]] const PartList& running() const noexcept {
    return lent_ != nullptr ? *lent_ : own_;
  }

  Config config_;
  signal::ForceEnvelope envelope_;
  Force force_;
  PartList own_;
  PartList* lent_ = nullptr;  ///< by use(); else its own run
  bool follows_;              ///< a part says how, not the model
  std::int64_t engaged_ = 0;  ///< ticks that the parts have been acting, up to fade_ticks
  double force_n_ = 0.0;      ///< of the tick before
  double theta_rad_ = 0.0;    ///< the newest finite one
  double off_rad_ = 0.0;      ///< taken off in full effect, the newest finite one
  bool finite_ = true;        ///< what the parts ask for is
};

}  // namespace stillhand::cancellation
