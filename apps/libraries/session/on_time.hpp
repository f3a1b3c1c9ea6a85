// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/libraries/session/force_budget.hpp"
#include "apps/libraries/session/session_recording.hpp"
#include "services/core/cancellation/config.hpp"
#include "services/core/cancellation/parts/countermeasure.hpp"
#include "services/core/contract/trial.hpp"
#include "services/core/rig/parts/body_config.hpp"
#include "services/core/rig/parts/motor.hpp"
#include "services/core/sensing/conditioner.hpp"

namespace stillhand::session {

/// Settings of what lies between a raw sample and the motor's force.
struct AnswerConfigs {
  sensing::Config sensing;
  cancellation::Config cancellation;
  rig::MotorConfig motor;
  double lever_m = rig::StickConfig{}.lever_m;  ///< hand to pivot
};

/// What the motor would do with each raw sample answered in its tick, README Eq. SN-9: conditioner,
/// canceller and motor, without a process in between.  A copy goes on on its own.  step() does not
/// allocate.
class OnTime {
 public:
  /// @throws ConfigError as the cores do.
  explicit OnTime(const AnswerConfigs& configs);

  /// The model from the next sample on.  @return false: the canceller refuses it
  bool load_model(const cancellation::ControlModel& model);
  /// Until the first model is in full effect [ticks].
  [[nodiscard]] std::int64_t unsettled_ticks() const noexcept {
    return sensed_.canceller.unsettled_ticks();
  }

  struct Answer {
    AskedForces forces;
    double predicted_n;  ///< f^ of the sample as it was sensed
  };
  /// @param accel_m_s2  true lateral acceleration of the platform; NaN: not known, the sensor's
  /// @param cancels     the motor may act
  Answer step(const sensing::DeviceSample& sample, double accel_m_s2, bool cancels) noexcept;

 private:
  struct Chain {
    Chain(const AnswerConfigs& configs, bool answers_in_tick);
    void step(const sensing::DeviceSample& sample, bool cancels) noexcept;

    sensing::Conditioner conditioner;
    cancellation::Countermeasure canceller;
    rig::Motor motor;
    bool in_tick;
    double command_n = 0.0, predicted_n = 0.0, motor_n = 0.0;
  };

  sensing::Config sensing_;
  Chain sensed_, unlimited_, noiseless_;
};

/// Number of the first model that a trial's motor commands name; none: the canceller had none.
std::optional<std::int32_t> model_in_use(const SessionRecording& session, const Trial& trial);

/// What is left of the feedthrough in a trial, by cause, or why it is not known.
struct SplitTrial {
  std::optional<ForceBudget> budget = {};
  std::string why = {};
};

/// README Eq. SN-8 to SN-10, of a trial with cancellation.
/// @param configs  that the session ran with; others are found out by the recorded predictions
SplitTrial split_trial(const SessionRecording& session, const Trial& trial,
                       const AnswerConfigs& configs);

}  // namespace stillhand::session
