// SPDX-License-Identifier: Apache-2.0
#include "services/messages/rig/codec.hpp"

#include <limits>

namespace stillhand::rig {
namespace {

// Ticks since the sample that a message answers; a message can carry any number, and where the
// difference does not fit, the end of the type is as unusable.
Tick age_ticks(Tick now, Tick answered) noexcept {
  Tick age = 0;
  if (!__builtin_sub_overflow(now, answered, &age)) return age;
  return answered < 0 ? std::numeric_limits<Tick>::max() : std::numeric_limits<Tick>::min();
}

}  // namespace

stillhand_msgs::RawSample to_idl(const RigOutput& output, Tick tick) {
  stillhand_msgs::RawSample message;
  message.tick(tick);
  message.accel_x_v(output.raw.accel_x_v);
  message.accel_y_v(output.raw.accel_y_v);
  message.accel_z_v(output.raw.accel_z_v);
  message.load_cell_v(output.raw.load_cell_v);
  message.encoder_counts(output.raw.encoder_counts);
  message.roll_rad(output.raw.roll_rad);
  message.flags(output.all_flags());
  return message;
}

stillhand_msgs::RigTruth to_idl(const RigOutput& output, Tick tick, const RigInput& input,
                                const UsedTicks& used) {
  stillhand_msgs::RigTruth message;
  message.tick(tick);
  message.platform_position_m(output.truth.platform_position_m);
  message.platform_velocity_m_s(output.truth.platform_velocity_m_s);
  message.platform_acceleration_m_s2(output.truth.platform_acceleration_m_s2);
  message.theta_rad(output.truth.theta_rad);
  message.omega_rad_s(output.truth.omega_rad_s);
  message.feedthrough_force_n(output.truth.feedthrough_force_n);
  message.motor_force_n(output.truth.motor_force_n);
  message.volitional_force_n(output.truth.volitional_force_n);
  message.hand_force_n(output.truth.hand_force_n);
  message.command_tick(used.command);
  message.motor_tick(used.motor);
  message.operator_tick(used.volition);
  message.pegged(input.pegged);
  message.motor_permitted(input.motor_permitted);
  message.flags(output.all_flags());
  return message;
}

RigInput make_input(Tick tick, const stillhand_msgs::PlatformCommand* command,
                    const stillhand_msgs::MotorCommand* motor,
                    const stillhand_msgs::OperatorForce* volition, bool pegged,
                    bool motor_permitted) {
  RigInput input;
  if (command != nullptr) {
    input.command_valid = true;
    input.command_position_m = command->position_m();
    input.command_velocity_m_s = command->velocity_m_s();
    input.command_acceleration_m_s2 = command->acceleration_m_s2();
  }
  put_motor(input, tick, motor, motor_permitted);
  if (volition != nullptr) {
    input.operator_valid = true;
    input.operator_age_ticks = age_ticks(tick, volition->tick());
    input.operator_force_n = volition->force_n();
  }
  input.pegged = pegged;
  return input;
}

void put_motor(RigInput& input, Tick tick, const stillhand_msgs::MotorCommand* motor,
               bool permitted) {
  input.motor_valid = motor != nullptr;
  input.motor_permitted = permitted;
  if (motor == nullptr) return;
  input.motor_age_ticks = age_ticks(tick, motor->tick());
  input.motor_force_n = motor->force_n();
}

}  // namespace stillhand::rig
