// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/parts/scheduled_force.hpp"

#include <algorithm>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"

namespace stillhand::cancellation {
namespace {

constexpr double kLowOfDifference_hz = 0.5;
constexpr double kHighOfDifference_hz = 3.0;
constexpr int kDifferenceOrder = 2;
// Motion that holds the start's w against noise.
constexpr double kStart_m = 2e-4;

}  // namespace

ScheduledForce::ScheduledForce(const ScheduleConfig& config)
    : relaxed_(config.relaxed, config.stick),
      holding_(config.holding, config.stick),
      lever_m_(config.lever_m),
      forget_(kControlPeriod_s / config.memory_s),
      of_difference_(kDifferenceOrder, kLowOfDifference_hz, kHighOfDifference_hz, kControlRateHz),
      of_motion_(of_difference_),
      power_(kStart_m * kStart_m),
      cross_(0.5 * kStart_m * kStart_m) {
  if (!(config.lever_m > 0.0)) {
    throw ConfigError("schedule.lever_m", std::to_string(config.lever_m), "above 0");
  }
  if (!(config.memory_s >= 0.1 && config.memory_s <= 1000.0)) {
    throw ConfigError("schedule.memory_s", std::to_string(config.memory_s), "0.1 to 1000 s");
  }
}

double ScheduledForce::step(double accel_m_s2, double theta_rad, double motor_n) noexcept {
  const ArmPrediction soft = relaxed_.step(accel_m_s2, motor_n);
  const ArmPrediction stiff = holding_.step(accel_m_s2, motor_n);
  const double d = of_difference_.step(stiff.displacement_m - soft.displacement_m);
  const double y = of_motion_.step(lever_m_ * theta_rad - soft.displacement_m);
  // Eq. MI-5.
  power_ += forget_ * (d * d - power_);
  cross_ += forget_ * (d * y - cross_);
  // Two arms that predict the same motion say nothing, and w stays.
  constexpr double kLeast_m2 = 1e-14;
  if (power_ > kLeast_m2) weight_ = std::clamp(cross_ / power_, 0.0, 1.0);
  return soft.held_n + weight_ * (stiff.held_n - soft.held_n);
}

}  // namespace stillhand::cancellation
