// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/parts/motor.hpp"

#include <algorithm>
#include <cmath>

namespace stillhand::rig {
namespace {

const MotorConfig& checked(const MotorConfig& config) {
  validate(config, "rig.motor");
  return config;
}

}  // namespace

Motor::Motor(const MotorConfig& config, double lever_m)
    : envelope_(checked(config).limits),
      max_age_ticks_(config.max_motor_age_ticks),
      current_limit_n_(config.current_limit_a * config.torque_constant_n_m_a *
                       config.capstan_ratio / lever_m),
      lag_blend_(1.0 - std::exp(-kControlPeriod_s / config.lag_s)),
      gain_(config.gain),
      delay_(static_cast<std::size_t>(ticks_in(config.delay_s))) {}

bool Motor::usable(const MotorDemand& demand) const noexcept {
  return demand.permitted && demand.valid && fresh(demand) && std::isfinite(demand.force_n);
}

Motor::Output Motor::step(const MotorDemand& demand) noexcept {
  Flags flags = kGood;
  if (!demand.permitted) flags |= kInhibited;
  if (demand.valid && !fresh(demand)) flags |= kInputStale;
  if (demand.valid && !std::isfinite(demand.force_n)) flags |= kInputInvalid;
  const bool counts = usable(demand);

  if (counts) {
    const double wanted_n = delay_.step(gain_ * demand.force_n);
    const double target_n = std::clamp(wanted_n, -current_limit_n_, current_limit_n_);
    if (target_n != wanted_n) flags |= kSaturated;
    lagged_n_ += lag_blend_ * (target_n - lagged_n_);
  }
  const auto out = envelope_.step(lagged_n_, counts);
  // After a gap, the lag starts from the present force, not from the force before the gap.
  if (!counts) {
    lagged_n_ = out.force_n;
    delay_.reset();
  }
  return {out.force_n, flags | out.flags};
}

}  // namespace stillhand::rig
