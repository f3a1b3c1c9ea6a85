// SPDX-License-Identifier: Apache-2.0
#include "services/messages/vehicle/codec.hpp"

namespace stillhand::vehicle {

StickSample from_idl(const stillhand_msgs::Sensed& message) noexcept {
  const bool sound = (message.flags() & (kInputInvalid | kInputStale | kFault)) == 0;
  return {message.tick(), message.theta_rad(), sound};
}

bool driven(const stillhand_msgs::TrialAssignment& assignment, const Trial& trial) noexcept {
  return trial.phase == TrialPhase::kTracking &&
         assignment.motion() != stillhand_msgs::MOTION_STILL;
}

}  // namespace stillhand::vehicle
