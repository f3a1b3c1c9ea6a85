// SPDX-License-Identifier: Apache-2.0
#include "services/cancellation/core/perturbation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stillhand::cancellation {

Perturbation::Perturbation(signal::Multisine force, const Config& config)
    : force_(std::move(force)),
      max_acceleration_m_s2_(config.max_acceleration_m_s2),
      envelope_(config.limits) {}

double Perturbation::wanted(Tick tick, const Trial& trial) const noexcept {
  const Tick since = tick - trial.start_tick;
  const Tick period = force_.samples_per_period();
  const Tick phase = ((since % period) + period) % period;
  const Tick outside = since < 0 ? -since : std::max<Tick>(0, since - trial.duration_ticks + 1);
  const double share = trial.ramp_ticks > 0 ? 1.0 - static_cast<double>(outside) /
                                                        static_cast<double>(trial.ramp_ticks)
                                            : 1.0;
  return std::clamp(share, 0.0, 1.0) * force_.at(phase).accel_m_s2;
}

CancellerOutput Perturbation::step(const CancellerInput& input, const Trial& trial) noexcept {
  constexpr Flags kUnsound = kInputInvalid | kInputStale | kFault;
  Flags flags = input.sensed_flags & kUnsound;
  const bool finite =
      std::ranges::all_of(input.sensed, [](double value) { return std::isfinite(value); });
  const double acceleration = input.sensed[static_cast<std::size_t>(Channel::kAccelY)];
  if (!finite || !(std::abs(acceleration) <= max_acceleration_m_s2_)) flags |= kInputInvalid;
  // A sender that is stuck, or whose clock began again.
  if (input.tick <= last_tick_) flags |= kInputInvalid;
  last_tick_ = input.tick;
  if (!input.permitted) flags |= kInhibited;
  const bool acting =
      input.enabled && input.permitted && trial.covers(input.tick) && (flags & kUnsound) == 0;
  const auto limited = envelope_.step(acting ? wanted(input.tick, trial) : 0.0, acting);
  return {limited.force_n, 0.0, flags | limited.flags, AdaptiveGain::Pair{1.0, 0.0}};
}

}  // namespace stillhand::cancellation
