// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/motion/core/platform_command.hpp"
#include "services/rig/core/rig.hpp"
#include "services/sensing/core/conditioner.hpp"

namespace stillhand::study {

/// A person on the simulated rig behind the session's sensors, a tick in two halves (RG-38) as in
/// session::InProcessLoop; what moves platform and motor is the caller's.
class HandStand {
 public:
  explicit HandStand(const rig::RigConfig& config)
      : rig_(config), conditioner_(sensing::Config{}) {}

  /// The first half: the sample of the tick.
  sensing::Sensed sample(Tick tick, const motion::PlatformCommand& command, double operator_n,
                         bool pegged) noexcept {
    input_.command_valid = true;
    input_.command_position_m = command.position_m;
    input_.command_velocity_m_s = command.velocity_m_s;
    input_.command_acceleration_m_s2 = command.acceleration_m_s2;
    input_.operator_valid = true;
    input_.operator_age_ticks = 1;
    input_.operator_force_n = operator_n;
    input_.pegged = pegged;
    out_ = rig_.sample(input_);
    const rig::RawSample& raw = out_.raw;
    return conditioner_.step({tick, raw.accel_x_v, raw.accel_y_v, raw.accel_z_v, raw.load_cell_v,
                              raw.encoder_counts, raw.roll_rad});
  }

  /// The second half: the motor's force until the next sample.
  const rig::RigTruth& drive(double motor_n, bool permitted) noexcept {
    input_.motor_valid = true;
    input_.motor_age_ticks = 0;
    input_.motor_force_n = motor_n;
    input_.motor_permitted = permitted;
    rig_.drive(input_, out_);
    return out_.truth;
  }

 private:
  rig::Rig rig_;
  sensing::Conditioner conditioner_;
  rig::RigInput input_;
  rig::RigOutput out_{};
};

}  // namespace stillhand::study
