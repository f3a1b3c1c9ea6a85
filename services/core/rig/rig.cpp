// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/rig.hpp"

#include <cmath>
#include <utility>

#include "services/core/contract/expects.hpp"
#include "services/core/rig/undeclared/undeclared_effect.hpp"

namespace stillhand::rig {
namespace {

const RigConfig& checked(const RigConfig& config) {
  validate(config, "rig");
  return config;
}

/// The slew limit is too high to restrict a person; a lost force fades in 50 ticks.
signal::ForceLimits volitional_limits(const RigConfig& config) {
  return {.max_force_n = config.max_operator_force_n, .max_slew_n_s = 20000.0, .ramp_ticks = 50};
}

}  // namespace

Rig::Rig(const RigConfig& config, SealedEffect sealed)
    : sealed_(std::move(sealed)),
      max_operator_age_ticks_(checked(config).max_operator_age_ticks),
      platform_(config.platform),
      motor_(config.motor, config.stick.lever_m),
      operator_envelope_(volitional_limits(config)),
      neuromuscular_(config.body.neuromuscular, static_cast<std::uint64_t>(config.seed)),
      body_(config.body, config.stick, kControlPeriod_s, chain_effect()),
      sensors_(config.sensors, static_cast<std::uint64_t>(config.seed)) {}

Rig::~Rig() = default;
Rig::Rig(Rig&&) noexcept = default;
Rig& Rig::operator=(Rig&&) noexcept = default;

const ChainEffect& Rig::chain_effect() const noexcept {
  static constexpr ChainEffect kNothing;
  return sealed_.effect_ ? sealed_.effect_->on_chain() : kNothing;
}

OpenedEffect Rig::open_effect() {
  STILLHAND_EXPECTS(!opened_);
  opened_ = true;
  return std::move(sealed_).open();
}

Motor::Output Rig::motor(const RigInput& input) noexcept {
  MotorDemand demand{input.motor_valid, input.motor_age_ticks, input.motor_force_n,
                     input.motor_permitted};
  if (sealed_.effect_) {
    demand.force_n = sealed_.effect_->motor_force(demand.force_n, motor_.usable(demand));
  }
  return motor_.step(demand);
}

signal::ForceEnvelope::Output Rig::volitional(const RigInput& input) noexcept {
  Flags flags = kGood;
  const bool fresh =
      input.operator_age_ticks >= 0 && input.operator_age_ticks <= max_operator_age_ticks_;
  if (input.operator_valid && !fresh) flags |= kInputStale;
  if (!input.operator_valid) return operator_envelope_.step(0.0, false);
  auto out = operator_envelope_.step(input.operator_force_n, fresh);
  out.flags |= flags;
  return out;
}

RigOutput Rig::step(const RigInput& input) noexcept {
  driven_ = motor(input);
  return sample(input);
}

void Rig::drive(const RigInput& input, RigOutput& output) noexcept {
  STILLHAND_EXPECTS(!opened_);
  driven_ = motor(input);
  output.truth.motor_force_n = driven_.force_n;
  output.motor_flags = driven_.flags;
}

RigOutput Rig::sample(const RigInput& input) noexcept {
  STILLHAND_EXPECTS(!opened_);
  const auto platform =
      platform_.step({input.command_valid, input.command_position_m, input.command_velocity_m_s,
                      input.command_acceleration_m_s2, input.leave == MotionLeave::kHold});
  const auto person = volitional(input);
  UndeclaredEffect* const effect = sealed_.effect_.get();
  UndeclaredEffect::Shaken shaken{};
  double accel_y_m_s2 = platform.state.acceleration_m_s2;
  double accel_z_m_s2 = kGravity_m_s2;
  if (effect != nullptr) {
    shaken = effect->step(platform.state);
    // Eq. RG-23: accelerations of masses and accelerometers along the rolled axes.
    const double sine = std::sin(shaken.roll_rad);
    const double cosine = std::cos(shaken.roll_rad);
    const double along_m_s2 = accel_y_m_s2;
    accel_y_m_s2 = along_m_s2 * cosine - kGravity_m_s2 * sine;
    accel_z_m_s2 = along_m_s2 * sine + kGravity_m_s2 * cosine;
  }
  const auto added = neuromuscular_.step({accel_y_m_s2, driven_.force_n, input.pegged});
  const auto body = body_.step({accel_y_m_s2, driven_.force_n, person.force_n + added.resisting_n,
                                input.pegged, shaken.hand_n + added.hand_n, added.stiffness_level});
  const double cell_n =
      effect != nullptr ? effect->cell_force(body.hand_force_n) : body.hand_force_n;
  const auto sensed = sensors_.step({.accel_x_m_s2 = shaken.accel_x_m_s2,
                                     .accel_y_m_s2 = accel_y_m_s2,
                                     .accel_z_m_s2 = accel_z_m_s2,
                                     .force_n = cell_n,
                                     .theta_rad = body.theta_rad,
                                     .roll_rad = shaken.roll_rad});
  return {.raw = sensed.raw,
          .truth = {.platform_position_m = platform.state.position_m,
                    .platform_velocity_m_s = platform.state.velocity_m_s,
                    .platform_acceleration_m_s2 = platform.state.acceleration_m_s2,
                    .theta_rad = body.theta_rad,
                    .omega_rad_s = body.omega_rad_s,
                    .feedthrough_force_n = body.feedthrough_force_n,
                    .motor_force_n = driven_.force_n,
                    .volitional_force_n = person.force_n,
                    .hand_force_n = body.hand_force_n},
          .flags = platform.flags | person.flags | body.flags | sensed.flags,
          .motor_flags = driven_.flags};
}

}  // namespace stillhand::rig
