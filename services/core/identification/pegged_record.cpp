// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/pegged_record.hpp"

#include <utility>

#include "services/core/contract/tick.hpp"

namespace stillhand::identification {

std::string why_unusable(const PeggedTrial& trial) {
  constexpr double kMaxLostShare = 0.01;
  if (static_cast<double>(trial.lost) <= kMaxLostShare * static_cast<double>(trial.record.size())) {
    return {};
  }
  return std::to_string(trial.lost) + " ticks of the pegged trial were lost";
}

void PeggedRecord::begin(const Trial& trial) {
  trial_ = trial;
  active_ = true;
  lost_ = 0;
  record_.rate_hz = kControlRateHz;
  record_.acceleration_m_s2.clear();
  record_.force_n.clear();
  record_.acceleration_m_s2.reserve(static_cast<std::size_t>(trial.duration_ticks));
  record_.force_n.reserve(static_cast<std::size_t>(trial.duration_ticks));
}

bool PeggedRecord::take(Tick tick, double accel_m_s2, double force_n) {
  if (!active_ || tick < trial_.start_tick) return false;
  const Tick end = trial_.start_tick + trial_.duration_ticks;
  const Tick expected = trial_.start_tick + static_cast<Tick>(record_.size());
  if (tick < expected) return false;
  if (tick < end) {
    const Tick missing = tick - expected;
    lost_ += missing;
    const double a0 = record_.size() > 0 ? record_.acceleration_m_s2.back() : accel_m_s2;
    const double f0 = record_.size() > 0 ? record_.force_n.back() : force_n;
    for (Tick i = 1; i <= missing + 1; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(missing + 1);
      record_.acceleration_m_s2.push_back(a0 + share * (accel_m_s2 - a0));
      record_.force_n.push_back(f0 + share * (force_n - f0));
    }
  }
  active_ = tick < end - 1;
  return !active_;
}

PeggedTrial PeggedRecord::release() noexcept {
  active_ = false;
  return {std::exchange(record_, {}), lost_, trial_.number};
}

}  // namespace stillhand::identification
