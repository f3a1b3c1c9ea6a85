// SPDX-License-Identifier: Apache-2.0
#include "services/display/codec.hpp"

namespace stillhand::display {

TrackingInput from_idl(const stillhand_msgs::Sensed& sensed) {
  return {sensed.tick(), sensed.theta_rad()};
}

stillhand_msgs::TrackingSample to_idl(const TrackingSample& sample, Tick tick, std::int64_t trial) {
  stillhand_msgs::TrackingSample message;
  message.tick(tick);
  message.target_m(sample.target_m);
  message.cursor_m(sample.cursor_m);
  message.inside(sample.inside);
  message.trial(static_cast<std::int32_t>(trial));
  message.flags(sample.flags);
  return message;
}

}  // namespace stillhand::display
