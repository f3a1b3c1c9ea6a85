// SPDX-License-Identifier: Apache-2.0
#include "services/core/motion/platform_guard.hpp"

#include <algorithm>
#include <cmath>

namespace stillhand::motion {
namespace {

constexpr double kDt_s = kControlPeriod_s;

bool finite(const PlatformCommand& c) noexcept {
  return std::isfinite(c.position_m) && std::isfinite(c.velocity_m_s) &&
         std::isfinite(c.acceleration_m_s2);
}

// Within the limits at this instant, and able to stop before the wall: Eq. MO-1 times 2A, which
// spares the division.
bool viable(const PlatformCommand& c, const PlatformLimits& limits) noexcept {
  const double twice_m_s2 = 2.0 * limits.max_acceleration_m_s2;
  const double stop = twice_m_s2 * c.position_m + c.velocity_m_s * std::abs(c.velocity_m_s);
  return std::abs(c.position_m) <= limits.max_position_m &&
         std::abs(c.velocity_m_s) <= limits.max_velocity_m_s &&
         std::abs(c.acceleration_m_s2) <= limits.max_acceleration_m_s2 &&
         std::abs(stop) <= twice_m_s2 * limits.max_position_m;
}

PlatformCommand clipped(const PlatformCommand& c, const PlatformLimits& limits) noexcept {
  const auto clip = [](double value, double bound) { return std::clamp(value, -bound, bound); };
  return {clip(c.position_m, limits.max_position_m), clip(c.velocity_m_s, limits.max_velocity_m_s),
          clip(c.acceleration_m_s2, limits.max_acceleration_m_s2), c.flags};
}

}  // namespace

PlatformGuard::PlatformGuard(const PlatformLimits& limits, double most_jerk_m_s3)
    : limits_(limits), most_jerk_m_s3_(most_jerk_m_s3) {
  validate(limits, "motion.limits");
}

void PlatformGuard::stand_at(double position_m) noexcept {
  if (!(std::abs(position_m) <= limits_.max_position_m)) return;
  state_ = {.position_m = position_m};
  asked_before_ = false;
}

PlatformCommand PlatformGuard::step(const GuardInput& input) noexcept {
  const bool usable = input.valid && finite(input.command);
  if (!usable) {
    move(braking_velocity());
    asked_before_ = false;
    state_.flags =
        input.valid ? (input.command.flags | kInputInvalid) : static_cast<Flags>(kInputStale);
    return state_;
  }
  if (reachable(input.command)) {
    state_ = asked_ = input.command;
  } else {
    const PlatformCommand next = clipped(input.command, limits_);
    move(smoothed(approach_velocity(next)));
    state_.flags = input.command.flags | kWorkspaceLimit;
    asked_ = next;
  }
  asked_before_ = true;
  return state_;
}

// Eq. MO-2.
bool PlatformGuard::reachable(const PlatformCommand& next) const noexcept {
  if (!viable(next, limits_)) return false;
  const double full_m_s = limits_.max_acceleration_m_s2 * kDt_s;
  const double change_m_s = next.velocity_m_s - state_.velocity_m_s;
  if (std::abs(change_m_s) > full_m_s) return false;
  if (std::abs(next.acceleration_m_s2 - state_.acceleration_m_s2) > most_jerk_m_s3_ * kDt_s) {
    return false;
  }
  const double trapezoid_m = 0.5 * (state_.velocity_m_s + next.velocity_m_s) * kDt_s;
  const double deviation_m = next.position_m - state_.position_m - trapezoid_m;
  return std::abs(deviation_m) * (4.0 * limits_.max_acceleration_m_s2) <=
         full_m_s * full_m_s - change_m_s * change_m_s;
}

// Eq. MO-3: the velocity error follows a profile that is linear near the command and a constant
// deceleration farther out, so that large errors close without overshoot.
double PlatformGuard::approach_velocity(const PlatformCommand& next) const noexcept {
  const double full_m_s = limits_.max_acceleration_m_s2 * kDt_s;
  const double before_m_s = asked_before_
                                ? std::clamp(asked_.velocity_m_s, next.velocity_m_s - full_m_s,
                                             next.velocity_m_s + full_m_s)
                                : next.velocity_m_s - next.acceleration_m_s2 * kDt_s;
  const double error_m =
      state_.position_m + 0.5 * (state_.velocity_m_s + next.velocity_m_s) * kDt_s - next.position_m;
  const double error_m_s = state_.velocity_m_s - before_m_s;
  // Half the deceleration allowed leaves the other half to follow the bend of the profile.
  const double bend_m_s2 = 0.5 * limits_.stop_acceleration_m_s2;
  const double w = limits_.catch_up_rad_s;
  const double linear_m = bend_m_s2 / (w * w);
  const double distance_m = std::abs(error_m);
  const double speed_m_s = distance_m <= linear_m
                               ? w * distance_m
                               : std::sqrt(2.0 * bend_m_s2 * (distance_m - 0.5 * linear_m));
  const double wanted_m_s = -std::copysign(speed_m_s, error_m);
  const double most_m_s = limits_.stop_acceleration_m_s2 * kDt_s;
  const double gain = std::min(4.0 * w * kDt_s, 1.0);
  return next.velocity_m_s + error_m_s +
         std::clamp(gain * (wanted_m_s - error_m_s), -most_m_s, most_m_s);
}

// Eq. MO-16: the acceleration comes from the one before, and braking ends as softly as it began.
double PlatformGuard::smoothed(double velocity_m_s) const noexcept {
  const double most_m_s2 = most_jerk_m_s3_ * kDt_s;
  return std::clamp(velocity_m_s,
                    state_.velocity_m_s + (state_.acceleration_m_s2 - most_m_s2) * kDt_s,
                    state_.velocity_m_s + (state_.acceleration_m_s2 + most_m_s2) * kDt_s);
}

double PlatformGuard::least_braking_m_s2() const noexcept {
  const double least_m_s2 = std::min(limits_.stop_acceleration_m_s2, limits_.max_acceleration_m_s2);
  if (most_jerk_m_s3_ == kAnyJerk_m_s3) return least_m_s2;
  return std::min(least_m_s2, std::sqrt(2.0 * most_jerk_m_s3_ * std::abs(state_.velocity_m_s)));
}

// Eq. MO-4.
double PlatformGuard::braking_velocity() const noexcept {
  const double speed_m_s = std::abs(state_.velocity_m_s);
  if (speed_m_s == 0.0) return smoothed(0.0);
  const double gap_m =
      limits_.max_position_m - std::copysign(1.0, state_.velocity_m_s) * state_.position_m;
  const double needed_m_s2 =
      gap_m > 0.0 ? speed_m_s * speed_m_s / (2.0 * gap_m) : limits_.max_acceleration_m_s2;
  const double deceleration_m_s2 =
      std::clamp(needed_m_s2, least_braking_m_s2(), limits_.max_acceleration_m_s2);
  const double slower_m_s =
      std::copysign(std::max(speed_m_s - deceleration_m_s2 * kDt_s, 0.0), state_.velocity_m_s);
  return needed_m_s2 > limits_.stop_acceleration_m_s2 ? slower_m_s : smoothed(slower_m_s);
}

// Eq. MO-5, towards a wall that is gap_m away; the second form of the root avoids cancellation.
double PlatformGuard::highest_velocity(double gap_m, double velocity_m_s) const noexcept {
  const double free_m = gap_m - 0.5 * velocity_m_s * kDt_s;
  if (free_m < 0.0) return 2.0 * gap_m / kDt_s - velocity_m_s;
  const double half_m_s = 0.5 * limits_.max_acceleration_m_s2 * kDt_s;
  const double twice = 2.0 * limits_.max_acceleration_m_s2 * free_m;
  return twice / (half_m_s + std::sqrt(half_m_s * half_m_s + twice));
}

void PlatformGuard::move(double velocity_m_s) noexcept {
  const double x_m = state_.position_m;
  const double v_m_s = state_.velocity_m_s;
  const double full_m_s = limits_.max_acceleration_m_s2 * kDt_s;
  velocity_m_s = std::clamp(velocity_m_s, std::max(v_m_s - full_m_s, -limits_.max_velocity_m_s),
                            std::min(v_m_s + full_m_s, limits_.max_velocity_m_s));
  velocity_m_s = std::min(velocity_m_s, highest_velocity(limits_.max_position_m - x_m, v_m_s));
  velocity_m_s = std::max(velocity_m_s, -highest_velocity(limits_.max_position_m + x_m, -v_m_s));
  state_.position_m = std::clamp(x_m + 0.5 * (v_m_s + velocity_m_s) * kDt_s,
                                 -limits_.max_position_m, limits_.max_position_m);
  state_.velocity_m_s = velocity_m_s;
  state_.acceleration_m_s2 =
      std::clamp((velocity_m_s - v_m_s) / kDt_s, -limits_.max_acceleration_m_s2,
                 limits_.max_acceleration_m_s2);
}

}  // namespace stillhand::motion
