// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>

#include "services/core/cancellation/parts/countermeasure.hpp"
#include "services/core/motion/platform_command.hpp"
#include "services/core/rig/rig.hpp"
#include "services/core/sensing/conditioner.hpp"

namespace stillhand::session {

/// What moves the rig in a tick.
struct Turn {
  motion::PlatformCommand command;
  /// [N] of the tick before; nothing: nobody steers.
  std::optional<double> operator_force_n = std::nullopt;
  bool pegged = false;
  bool permitted = false;  ///< the motor's interlock
};

/// What came of it.
struct Turned {
  sensing::Sensed sensed;
  rig::RigTruth truth;
};

/// The loop of a session in one process: the rig behind its sensors, closed through whatever
/// answers a sample.  The answer drives the motor after the sample that it answers, as live
/// (RG-38), or with motor.answer_wait_s 0 at the beginning of the next tick.  Deterministic.  One
/// thread; turn() does not allocate.
class Loop {
 public:
  /// @throws ConfigError as the cores do.
  Loop(const rig::RigConfig& rig, const sensing::Config& sensing, rig::SealedEffect effect = {})
      : rig_(rig, std::move(effect)),
        conditioner_(sensing),
        same_tick_(rig.motor.answers_in_tick()) {}

  /// One tick.  @param answer  double(const sensing::Sensed&): [N] the motor's force, + right
  template <typename Answer>
  Turned turn(Tick tick, const Turn& turn, Answer&& answer) {
    rig::RigInput input;
    input.command_valid = true;
    input.command_position_m = turn.command.position_m;
    input.command_velocity_m_s = turn.command.velocity_m_s;
    input.command_acceleration_m_s2 = turn.command.acceleration_m_s2;
    input.motor_valid = true;
    input.motor_age_ticks = 1;
    input.motor_force_n = motor_force_n_;
    input.motor_permitted = turn.permitted;
    input.operator_valid = turn.operator_force_n.has_value();
    input.operator_age_ticks = 1;
    input.operator_force_n = turn.operator_force_n.value_or(0.0);
    input.pegged = turn.pegged;
    rig::RigOutput out = same_tick_ ? rig_.sample(input) : rig_.step(input);
    const rig::RawSample& raw = out.raw;
    const sensing::Sensed sensed =
        conditioner_.step({tick, raw.accel_x_v, raw.accel_y_v, raw.accel_z_v, raw.load_cell_v,
                           raw.encoder_counts, raw.roll_rad});
    motor_force_n_ = answer(sensed);
    if (same_tick_) {
      input.motor_age_ticks = 0;
      input.motor_force_n = motor_force_n_;
      rig_.drive(input, out);
    }
    return {sensed, out.truth};
  }

  /// [N] The newest answer.
  [[nodiscard]] double motor_force_n() const noexcept { return motor_force_n_; }
  /// The effect of the rig, once the verdict on it is written: no turn() after this call.
  [[nodiscard]] rig::OpenedEffect open_effect() { return rig_.open_effect(); }

 private:
  rig::Rig rig_;
  sensing::Conditioner conditioner_;
  bool same_tick_;
  double motor_force_n_ = 0.0;
};

/// A countermeasure's input of a sample.
inline cancellation::CountermeasureInput input_of(Tick tick, const sensing::Sensed& sensed,
                                                  bool enabled, bool permitted) noexcept {
  return {tick,
          {sensed.accel_x_m_s2, sensed.accel_y_m_s2, sensed.accel_z_m_s2, sensed.roll_rad,
           sensed.theta_rad, sensed.omega_rad_s},
          sensed.flags,
          enabled,
          permitted,
          {}};
}

}  // namespace stillhand::session
