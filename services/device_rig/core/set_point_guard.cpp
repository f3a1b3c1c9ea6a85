// SPDX-License-Identifier: Apache-2.0
#include "services/device_rig/core/set_point_guard.hpp"

#include <algorithm>
#include <cmath>

#include "services/contract/tick.hpp"

namespace stillhand::device_rig {
namespace {

// Time constant of the approach to a distant command.
constexpr double kApproach_s = 0.05;

}  // namespace

void SetPointGuard::stand_at(double position_m) noexcept {
  if (!std::isfinite(position_m)) return;
  position_m_ = std::clamp(position_m, -limits_.workspace_m, limits_.workspace_m);
  velocity_m_s_ = 0.0;
}

void SetPointGuard::brake() noexcept {
  const double change_m_s = limits_.stop_deceleration_m_s2 * kControlPeriod_s;
  velocity_m_s_ -= std::clamp(velocity_m_s_, -change_m_s, change_m_s);
}

SetPointGuard::Output SetPointGuard::step(const SetPoint& wanted) noexcept {
  Flags flags = kGood;
  const double before_m_s = velocity_m_s_;
  const bool finite = std::isfinite(wanted.position_m) && std::isfinite(wanted.velocity_m_s) &&
                      std::isfinite(wanted.acceleration_m_s2);
  if (!wanted.follow) flags |= kInputStale;
  if (wanted.follow && !finite) flags |= kInputInvalid;
  if (flags != kGood) {
    brake();
  } else {
    const double target_m =
        std::clamp(wanted.position_m, -limits_.workspace_m, limits_.workspace_m);
    if (target_m != wanted.position_m) flags |= kWorkspaceLimit;
    const double away_m = target_m - position_m_;
    const double change_m_s = limits_.max_acceleration_m_s2 * kControlPeriod_s;
    const double exact_m_s = away_m / kControlPeriod_s;
    const double toward_m_s =
        std::clamp(wanted.velocity_m_s, -limits_.max_velocity_m_s, limits_.max_velocity_m_s) +
        std::clamp(away_m / kApproach_s, -limits_.catch_velocity_m_s, limits_.catch_velocity_m_s);
    const bool reaches = std::abs(exact_m_s) <= limits_.max_velocity_m_s &&
                         std::abs(exact_m_s - velocity_m_s_) <= change_m_s;
    velocity_m_s_ +=
        std::clamp((reaches ? exact_m_s : toward_m_s) - velocity_m_s_, -change_m_s, change_m_s);
    velocity_m_s_ = std::clamp(velocity_m_s_, -limits_.max_velocity_m_s, limits_.max_velocity_m_s);
  }
  position_m_ += velocity_m_s_ * kControlPeriod_s;
  if (std::abs(position_m_) > limits_.workspace_m) {
    position_m_ = std::copysign(limits_.workspace_m, position_m_);
    velocity_m_s_ = 0.0;
    flags |= kWorkspaceLimit;
  }
  return {{.follow = flags == kGood || flags == kWorkspaceLimit,
           .position_m = position_m_,
           .velocity_m_s = velocity_m_s_,
           .acceleration_m_s2 = (velocity_m_s_ - before_m_s) / kControlPeriod_s},
          flags};
}

}  // namespace stillhand::device_rig
