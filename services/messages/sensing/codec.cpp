// SPDX-License-Identifier: Apache-2.0
#include "services/messages/sensing/codec.hpp"

namespace stillhand::sensing {

DeviceSample from_idl(const stillhand_msgs::RawSample& message) {
  DeviceSample sample;
  sample.tick = message.tick();
  sample.accel_x_v = message.accel_x_v();
  sample.accel_y_v = message.accel_y_v();
  sample.accel_z_v = message.accel_z_v();
  sample.load_cell_v = message.load_cell_v();
  sample.encoder_counts = message.encoder_counts();
  sample.roll_rad = message.roll_rad();
  return sample;
}

stillhand_msgs::Sensed to_idl(const Sensed& sensed, const stillhand_msgs::RawSample& raw) {
  stillhand_msgs::Sensed message;
  message.tick(raw.tick());
  message.acquired_ns(raw.stamp_ns());
  message.accel_x_m_s2(sensed.accel_x_m_s2);
  message.accel_y_m_s2(sensed.accel_y_m_s2);
  message.accel_z_m_s2(sensed.accel_z_m_s2);
  message.roll_rad(sensed.roll_rad);
  message.force_n(sensed.force_n);
  message.theta_rad(sensed.theta_rad);
  message.omega_rad_s(sensed.omega_rad_s);
  message.flags(sensed.flags);
  return message;
}

}  // namespace stillhand::sensing
