// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "services/cancellation/core/canceller.hpp"
#include "services/cancellation/core/command_filter.hpp"
#include "services/mitigation/core/command_shaping.hpp"
#include "services/mitigation/core/lms_filter.hpp"
#include "services/mitigation/core/model_line.hpp"
#include "services/mitigation/core/stick_impedance.hpp"
#include "services/mitigation/linear_arm.hpp"
#include "services/mitigation/scheduled_force.hpp"

namespace stillhand::mitigation {

/// Takes the motion that a model predicts off the command.
struct SignalConfig {
  signal::DifferenceModel feedthrough_to_position = {};  ///< G at 1 kHz: m per m/s^2
  /// Given: what the motor moves is taken off too, by this arm's compliance.
  std::optional<admittance::ArmValues> moved_by_motor = {};
  admittance::StickValues stick = {};
};

/// Which parts act; none is given: nothing is done.
struct Recipe {
  std::optional<cancellation::ControlModel> force =
      {};                                       ///< H of the paper, or one that adapts (CC-10)
  std::optional<ScheduleConfig> schedule = {};  ///< the force of Eq. MI-5
  std::optional<ImpedanceConfig> impedance = {};
  std::optional<LmsConfig> lms_force = {};
  std::optional<SignalConfig> signal = {};
  /// Given: `force` drives no motor, and CC-5 takes it off the command.
  std::optional<cancellation::HandCompliance> predicted_signal = {};
  std::optional<LmsConfig> lms_signal = {};
  std::optional<ShapingConfig> shaping = {};
  cancellation::Config canceller = {};  ///< its limits bound the sum of all forces
  double lever_m = 0.10;
};

struct MitigationOutput {
  double force_n;        ///< motor force wanted at the hand, + right, within the limits
  double command_rad;    ///< what the machine gets in place of the stick's angle; always finite
  double taken_off_rad;  ///< off the stick's angle; exactly 0 without a part on the command
  Flags flags;
  cancellation::AdaptiveGain::Pair weights = {1.0, 0.0};  ///< of `force`, Eq. CC-10
};

/// One mitigation, or several together, README Eq. MI-6:
///
///   wanted = canceller + e (-f^_schedule + impedance - y_lms),   force = ForceEnvelope(wanted)
///   command = theta - e (theta - shaping(theta - (G a + P force + y_lms) / lever))
///
/// e rises from 0 to 1 over the canceller's fade_ticks while the parts may act, so force and
/// command are continuous wherever a part begins or ends.  The force leaves zero only while
/// enabled, permitted and with a new, sound sample; it is zero within ramp_ticks otherwise,
/// whatever the parts ask for.  A tick without a sound sample does not step the parts: the
/// force begins its ramp at once, without CC-2's bridge, and what the parts take off the command is
/// held while e falls, so it is zero within ramp_ticks too.  So it is where what they ask for is
/// not finite.
/// One thread.  step() never allocates, locks or throws.
class Mitigation {
 public:
  /// @throws stillhand::ConfigError when a part's settings or models are refused.
  explicit Mitigation(const Recipe& recipe);

  MitigationOutput step(const cancellation::CancellerInput& input) noexcept;

  /// w of Eq. MI-5; 0 without a schedule.
  [[nodiscard]] double schedule_weight() const noexcept {
    return schedule_ ? schedule_->weight() : 0.0;
  }
  /// From the first step until the models of force and position have settled [ticks], CC-4; 0
  /// without a model.  The arms of MI-5 and the lag of CC-5 are not counted.
  [[nodiscard]] std::int64_t settle_ticks() const noexcept { return settle_ticks_; }

 private:
  [[nodiscard]] bool sound(const cancellation::CancellerInput& input) noexcept;
  double forces(double accel_m_s2, double theta_rad, double omega_rad_s) noexcept;
  /// What is to be taken off the stick's displacement in full effect [m].
  double moved(double accel_m_s2, double theta_rad, double predicted_n) noexcept;
  /// The same of the stick's angle [rad], the shaping included.
  double off(double accel_m_s2, double theta_rad, double predicted_n) noexcept;
  void learn(double theta_rad, bool learns) noexcept;

  cancellation::Canceller canceller_;
  signal::ForceEnvelope envelope_;
  std::optional<ScheduledForce> schedule_;
  std::optional<StickImpedance> impedance_;
  std::optional<LmsFilter> lms_force_;
  std::optional<ModelLine> signal_;
  std::optional<LinearArm> moved_by_motor_;
  std::optional<cancellation::CommandFilter> predicted_signal_;
  std::optional<LmsFilter> lms_signal_;
  std::optional<CommandShaping> shaping_;
  std::int64_t settle_ticks_ = 0;
  double lever_m_;
  double max_acceleration_m_s2_;
  std::int64_t fade_ticks_;
  std::int64_t fall_;         ///< of engaged_ a tick
  std::int64_t engaged_ = 0;  ///< ticks that the parts have been acting, up to fade_ticks
  double force_n_ = 0.0;      ///< of the tick before
  double lms_moved_m_ = 0.0;  ///< y of the signal form at this tick
  double theta_rad_ = 0.0;    ///< the newest finite one
  double off_rad_ = 0.0;      ///< taken off in full effect, the newest finite one
  bool finite_ = true;        ///< what the parts ask for is
  Tick last_tick_ = -1;
};

}  // namespace stillhand::mitigation
