// SPDX-License-Identifier: Apache-2.0
#include "services/core/motion/motion_generator.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "services/core/contract/config_error.hpp"

namespace stillhand::motion {

MotionGenerator::MotionGenerator(const Config& config) : guard_(config.limits) {}

void MotionGenerator::arm(MotionTrajectory&& trajectory, const Trial& trial) {
  if (!trial.sound()) {
    throw ConfigError("motion.trial", "a start at " + std::to_string(trial.start_tick),
                      "start, length and ramps of 0 to 2^60 ticks");
  }
  if (trial.duration_ticks != trajectory.duration_ticks() ||
      trial.ramp_ticks != trajectory.ramp_ticks()) {
    throw ConfigError("motion.trial",
                      std::to_string(trial.duration_ticks) + " ticks and ramps of " +
                          std::to_string(trial.ramp_ticks),
                      "those of its trajectory: " + std::to_string(trajectory.duration_ticks()) +
                          " and " + std::to_string(trajectory.ramp_ticks()));
  }
  std::swap(trajectory_, trajectory);
  trial_ = trial;
}

PlatformCommand MotionGenerator::step(Tick tick) noexcept {
  if (last_tick_ >= 0 && tick == last_tick_) return last_;
  Flags flags = kGood;
  if (last_tick_ >= 0 && tick != last_tick_ + 1) {
    flags = kInputGap;
    for (Tick t = std::max(last_tick_ + 1, tick - kMaxCatchUp); t < tick; ++t) advance(t);
  }
  last_ = advance(tick);
  last_.flags |= flags;
  last_tick_ = tick;
  return last_;
}

PlatformCommand MotionGenerator::advance(Tick tick) noexcept {
  GuardInput input;
  input.valid = true;
  if (trial_.covers(tick))
    input.command = trajectory_.at(tick - trial_.start_tick + trial_.ramp_ticks);
  return guard_.step(input);
}

}  // namespace stillhand::motion
