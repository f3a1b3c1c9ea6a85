// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/undeclared/undeclared_effect.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/contract/units.hpp"
#include "services/core/rig/parts/sensors.hpp"

namespace stillhand::rig {
namespace {

// Streams of the effect's seed.
constexpr std::uint64_t kForeAftStream = 0x66610001;
constexpr std::uint64_t kRollStream = 0x66610002;

// Below these limits for one second, the platform counts as standing still.
constexpr double kStill_m_s = 1e-3;
constexpr double kStill_m_s2 = 1e-2;
constexpr int kStillTicks = 1000;
// The shaking fades in and out with this lag, within the trial's ramps of two seconds.
constexpr double kGateLag_s = 0.5;

}  // namespace

UndeclaredEffect::UndeclaredEffect(const EffectPlan& plan)
    : plan_(plan),
      fore_aft_(plan.facts.seed, kForeAftStream,
                {kForeAftLow_hz, kForeAftHigh_hz, plan.fore_aft_rms_m_s2}),
      roll_(plan.facts.seed, kRollStream, {kRollLow_hz, kRollHigh_hz, plan.roll_rms_rad}),
      lag_blend_(plan.fore_aft_lag_s > 0.0 ? 1.0 - std::exp(-kControlPeriod_s / plan.fore_aft_lag_s)
                                           : 1.0),
      tone_step_rad_(kTwoPi * plan.tone_hz * kControlPeriod_s),
      tone_rad_(plan.tone_phase_rad),
      still_ticks_(kStillTicks),
      cell_delay_(plan.cell_delay_ticks),
      motor_delay_(plan.motor_delay_ticks) {}

double UndeclaredEffect::gate(const PlatformState& platform) noexcept {
  const bool moves = std::abs(platform.velocity_m_s) > kStill_m_s ||
                     std::abs(platform.acceleration_m_s2) > kStill_m_s2;
  still_ticks_ = moves ? 0 : std::min(still_ticks_ + 1, kStillTicks);
  const double wanted = still_ticks_ < kStillTicks ? 1.0 : 0.0;
  gate_ += kControlPeriod_s / kGateLag_s * (wanted - gate_);
  return gate_;
}

UndeclaredEffect::Shaken UndeclaredEffect::step(const PlatformState& platform) noexcept {
  const double open = gate(platform);
  Shaken out{};
  if (plan_.fore_aft_rms_m_s2 > 0.0) {
    out.accel_x_m_s2 = open * fore_aft_.step();
    lagged_m_s2_ += lag_blend_ * (out.accel_x_m_s2 - lagged_m_s2_);
    out.hand_n += plan_.fore_aft_mass_kg * lagged_m_s2_;
  }
  if (plan_.roll_rms_rad > 0.0) {
    out.roll_rad = open * roll_.step();
    out.hand_n += plan_.borne_mass_kg * kGravity_m_s2 * std::sin(out.roll_rad);
  }
  if (plan_.tone_n > 0.0) {
    out.hand_n += plan_.tone_n * std::sin(tone_rad_);
    tone_rad_ += tone_step_rad_;
    if (tone_rad_ > kTwoPi) tone_rad_ -= kTwoPi;
  }
  return out;
}

double UndeclaredEffect::motor_force(double wanted_n, bool usable) noexcept {
  if (plan_.motor_delay_ticks == 0) return wanted_n;
  if (!usable) {
    // After a gap the delay line starts empty.
    motor_delay_.reset();
    return wanted_n;
  }
  return motor_delay_.step(wanted_n);
}

double UndeclaredEffect::cell_force(double force_n) noexcept {
  return std::clamp(cell_delay_.step(force_n), -plan_.cell_limit_n, plan_.cell_limit_n);
}

}  // namespace stillhand::rig
