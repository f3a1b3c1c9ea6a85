// SPDX-License-Identifier: Apache-2.0
#include "services/core/vehicle/driven_motion.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace stillhand::vehicle {

namespace {

// Before the detector's filters are made of it.
const signal::OscillationLimits& validated(const signal::OscillationLimits& limits) {
  validate(limits, "vehicle.oscillation");
  return limits;
}

}  // namespace

DrivenMotion::DrivenMotion(const DrivenConfig& config)
    : guard_(config.limits),
      vehicle_(config.vehicle),
      oscillation_(validated(config.oscillation)) {}

void DrivenMotion::arm(motion::MotionTrajectory&& trajectory, const Trial& trial,
                       bool driven) noexcept {
  std::swap(trajectory_, trajectory);
  trial_ = trial;
  driven_ = driven;
  ended_ = false;
  vehicle_.reset();
  oscillation_.reset();
}

// The command fades in and out over the trial's ramps.
double DrivenMotion::share(Tick tick) const noexcept {
  if (!trial_.covers(tick)) return 0.0;
  const auto ramp = static_cast<double>(std::max<Tick>(trial_.ramp_ticks, 1));
  const auto in = static_cast<double>(tick - trial_.start_tick + trial_.ramp_ticks);
  const auto out =
      static_cast<double>(trial_.start_tick + trial_.duration_ticks + trial_.ramp_ticks - tick);
  return std::min({in / ramp, out / ramp, 1.0});
}

motion::PlatformCommand DrivenMotion::step(const StickSample& sample) noexcept {
  const Tick tick = sample.tick + kLead_ticks;
  motion::GuardInput input;
  input.valid = true;
  if (driven_ && !ended_ && trial_.covers(tick)) {
    // Every tick counts for the length of a half wave; an unsound angle holds the one before.
    const bool found = oscillation_.step(sample.sound ? sample.theta_rad
                                                      : std::numeric_limits<double>::quiet_NaN());
    const motion::PlatformCommand& at = guard_.state();
    const VehicleMotion moved = vehicle_.step(
        {sample.theta_rad, sample.sound, share(tick), at.position_m, at.velocity_m_s});
    input.command = {moved.position_m, moved.velocity_m_s, moved.acceleration_m_s2, moved.flags};
    ended_ = found;
  } else if (!driven_ && trial_.covers(tick)) {
    input.command = trajectory_.at(tick - trial_.start_tick + trial_.ramp_ticks);
  }
  if (!ended_) return guard_.step(input);
  motion::PlatformCommand braking = guard_.step({});
  braking.flags |= kFault;
  return braking;
}

}  // namespace stillhand::vehicle
