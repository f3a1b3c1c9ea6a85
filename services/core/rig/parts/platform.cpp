// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/parts/platform.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

namespace stillhand::rig {
namespace {

constexpr double kDt_s = kControlPeriod_s;

bool finite(const PlatformDemand& demand) noexcept {
  return std::isfinite(demand.position_m) && std::isfinite(demand.velocity_m_s) &&
         std::isfinite(demand.acceleration_m_s2);
}

/// Clips `value` to +-limit and sets `flag` if the value changed.
double limited(double value, double limit, Flag flag, Flags& flags) noexcept {
  const double inside = std::clamp(value, -limit, limit);
  if (inside != value) flags |= flag;
  return inside;
}

}  // namespace

Platform::Platform(const PlatformConfig& config) : config_(config) {
  validate(config, "rig.platform");
  const double omega_rad_s = 2.0 * std::numbers::pi * config.loop_frequency_hz;
  // The Routh criterion requires tau w < 2 z; half of it leaves a gain margin of two.
  if (config.torque_lag_s * omega_rad_s > config.loop_damping) {
    std::ostringstream want;
    want << "at most " << config.loop_damping / omega_rad_s
         << " (loop_damping / (2 pi loop_frequency_hz)); above it the position loop is near "
            "instability";
    throw ConfigError("rig.platform.torque_lag_s", std::to_string(config.torque_lag_s), want.str());
  }
  rate_gain_s_ = 2.0 * config.loop_damping * omega_rad_s;
  position_gain_s_ = omega_rad_s / (2.0 * config.loop_damping);
  brake_s2_m_ = 0.5 / config.max_acceleration_m_s2;
  lag_blend_ = 1.0 - std::exp(-kDt_s / config.torque_lag_s);
}

double Platform::wanted_acceleration(const PlatformDemand& demand, Flags& flags) const noexcept {
  const bool usable = demand.valid && !demand.held && finite(demand);
  if (!usable) {
    flags |= demand.held ? kInhibited : demand.valid ? kInputInvalid : kInputStale;
    return std::clamp(-rate_gain_s_ * state_.velocity_m_s, -config_.stop_deceleration_m_s2,
                      config_.stop_deceleration_m_s2);
  }
  const double position_m = limited(demand.position_m, config_.workspace_m, kSaturated, flags);
  const double velocity_m_s =
      limited(demand.velocity_m_s, config_.max_velocity_m_s, kSaturated, flags);
  const double forward_m_s2 =
      limited(demand.acceleration_m_s2, config_.max_acceleration_m_s2, kSaturated, flags);
  const double catch_up_m_s = std::clamp(position_gain_s_ * (position_m - state_.position_m),
                                         -config_.catch_velocity_m_s, config_.catch_velocity_m_s);
  return rate_gain_s_ * (velocity_m_s + catch_up_m_s - state_.velocity_m_s) +
         config_.acceleration_feedforward * forward_m_s2;
}

double Platform::brakeable(double room_m, double closing_m_s) const noexcept {
  const double most_m_s2 = config_.max_acceleration_m_s2;
  // The usual case, without a square root: a whole tick of full acceleration leaves room to brake.
  const double faster_m_s = std::abs(closing_m_s) + most_m_s2 * kDt_s;
  if (faster_m_s * (kDt_s + faster_m_s * brake_s2_m_) < room_m) return most_m_s2;
  const double half_m_s = 0.5 * most_m_s2 * kDt_s;
  const double square_m2_s2 =
      half_m_s * half_m_s + 2.0 * most_m_s2 * room_m - most_m_s2 * kDt_s * closing_m_s;
  // At least (closing - half)^2 while the platform can brake; only rounding makes it less.
  if (square_m2_s2 <= 0.0) return -most_m_s2;
  const double next_m_s = std::sqrt(square_m2_s2) - half_m_s;
  return std::max(-most_m_s2, (next_m_s - closing_m_s) * kControlRateHz);
}

PlatformDemand Platform::from_hold(const PlatformDemand& demand) noexcept {
  if (demand.held) held_ = true;
  if (demand.held || !demand.valid || !finite(demand)) return demand;
  const double command_m = std::clamp(demand.position_m, -config_.workspace_m, config_.workspace_m);
  if (held_) way_.begin(state_.position_m - command_m);
  held_ = false;
  if (way_.over()) return demand;
  const auto offset = way_.step();
  return {true, command_m + offset.position_m, demand.velocity_m_s + offset.velocity_m_s,
          demand.acceleration_m_s2 + offset.acceleration_m_s2};
}

Platform::Output Platform::step(const PlatformDemand& demand) noexcept {
  Flags flags = kGood;
  const double wanted_m_s2 = wanted_acceleration(from_hold(demand), flags);
  double a_m_s2 = state_.acceleration_m_s2 + lag_blend_ * (wanted_m_s2 - state_.acceleration_m_s2);

  a_m_s2 = limited(a_m_s2, config_.max_acceleration_m_s2, kSaturated, flags);
  const double top_m_s = config_.max_velocity_m_s;
  const double v_m_s = state_.velocity_m_s;
  const double within_top_m_s2 =
      std::clamp(a_m_s2, (-top_m_s - v_m_s) * kControlRateHz, (top_m_s - v_m_s) * kControlRateHz);
  if (within_top_m_s2 != a_m_s2) flags |= kSaturated;
  const double right_m_s2 = brakeable(config_.workspace_m - state_.position_m, v_m_s);
  const double left_m_s2 = -brakeable(config_.workspace_m + state_.position_m, -v_m_s);
  const double safe_m_s2 = std::max(left_m_s2, std::min(right_m_s2, within_top_m_s2));
  if (safe_m_s2 != within_top_m_s2) flags |= kWorkspaceLimit;

  state_.position_m += (v_m_s + 0.5 * safe_m_s2 * kDt_s) * kDt_s;
  state_.velocity_m_s = v_m_s + safe_m_s2 * kDt_s;
  state_.acceleration_m_s2 = safe_m_s2;
  // Only rounding can exceed the workspace here (Eq. RG-2).
  state_.position_m = std::clamp(state_.position_m, -config_.workspace_m, config_.workspace_m);
  return {state_, flags};
}

}  // namespace stillhand::rig
