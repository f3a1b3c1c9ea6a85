// SPDX-License-Identifier: Apache-2.0
#include "services/messages/motion/codec.hpp"

#include <cstddef>

#include "idl/enumerator.hpp"

namespace stillhand::motion {

// Motions of core and bus have one order.
static_assert(static_cast<std::size_t>(stillhand_msgs::MOTION_STILL) ==
              static_cast<std::size_t>(MotionKind::kStill));
static_assert(static_cast<std::size_t>(stillhand_msgs::MOTION_RIDE) ==
              static_cast<std::size_t>(MotionKind::kRide));

stillhand_msgs::PlatformCommand to_idl(const PlatformCommand& command, Tick tick,
                                       std::int64_t trial) {
  stillhand_msgs::PlatformCommand message;
  message.tick(tick);
  message.position_m(command.position_m);
  message.velocity_m_s(command.velocity_m_s);
  message.acceleration_m_s2(command.acceleration_m_s2);
  message.trial(static_cast<std::int32_t>(trial));
  message.flags(command.flags);
  return message;
}

MotionProfile from_idl(const stillhand_msgs::TrialAssignment& assignment, const Trial& trial) {
  MotionProfile profile;
  profile.kind = of_bus(assignment.motion(), stillhand_msgs::MOTION_RIDE, MotionKind::kStill);
  profile.band_low_hz = assignment.band_low_hz();
  profile.band_high_hz = assignment.band_high_hz();
  profile.band_order = assignment.band_order();
  profile.rms_m_s2 = assignment.rms_m_s2();
  profile.peak_m_s2 = assignment.peak_m_s2();
  profile.seed = assignment.motion_seed();
  profile.duration_ticks = trial.duration_ticks;
  profile.ramp_ticks = trial.ramp_ticks;
  return profile;
}

}  // namespace stillhand::motion
