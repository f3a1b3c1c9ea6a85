// SPDX-License-Identifier: Apache-2.0
#include "cancellation/codec.hpp"

namespace stillhand::cancellation {

CancellerInput from_idl(const stillhand_msgs::Sensed& sensed, bool enabled, bool permitted) {
  CancellerInput input{};
  input.tick = sensed.tick();
  // In Channel's order.
  input.sensed = {sensed.accel_x_m_s2(), sensed.accel_y_m_s2(), sensed.accel_z_m_s2(),
                  sensed.roll_rad(),     sensed.theta_rad(),    sensed.omega_rad_s()};
  input.sensed_flags = sensed.flags();
  input.enabled = enabled;
  input.permitted = permitted;
  return input;
}

ControlRateModel from_idl(const stillhand_msgs::FeedthroughModel& message) {
  return {message.control_rate_hz(), message.control_numerator(), message.control_denominator()};
}

stillhand_msgs::MotorCommand to_idl(const CancellerOutput& output, const CancellerInput& input,
                                    const stillhand_msgs::Sensed& sensed, std::int32_t model) {
  stillhand_msgs::MotorCommand message;
  message.tick(sensed.tick());
  message.acquired_ns(sensed.acquired_ns());
  message.force_n(output.force_n);
  message.predicted_force_n(output.predicted_force_n);
  message.model(model);
  message.enabled(input.enabled);
  message.permitted(input.permitted);
  message.flags(output.flags);
  return message;
}

}  // namespace stillhand::cancellation
