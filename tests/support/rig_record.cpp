// SPDX-License-Identifier: Apache-2.0
#include "tests/support/rig_record.hpp"

#include "services/core/rig/parts/chain.hpp"
#include "services/core/sensing/conditioner.hpp"
#include "services/core/signal/butterworth.hpp"

namespace stillhand::simulated {

namespace {

constexpr std::int64_t kEvery = 4;

sensing::DeviceSample device_sample_at(const rig::RawSample& raw, Tick tick) {
  return {tick,          raw.accel_x_v,   raw.accel_y_v,
          raw.accel_z_v, raw.load_cell_v, raw.encoder_counts,
          raw.roll_rad};
}

}  // namespace

RigRecord record(const RigRun& run) {
  rig::Rig rig(run.rig);
  const sensing::Config sensing;
  sensing::Conditioner conditioner(sensing);
  signal::Butterworth of_angle(2, sensing.antialias_cutoff_hz, kControlRateHz);
  signal::Butterworth of_motor(2, sensing.antialias_cutoff_hz, kControlRateHz);
  const std::int64_t period = run.motion->samples_per_period();
  RigRecord out;
  out.record.rate_hz = kControlRateHz / static_cast<double>(kEvery);
  signal::Butterworth of_step(2, sensing.antialias_cutoff_hz, kControlRateHz);
  // Of a step of the motor's force, hand and handle take this share through the load cell.
  const rig::ChainParameters chain = rig::chain_parameters(run.rig.body, run.rig.stick, true);
  const double share = chain.cell_mass_kg / chain.stick_mass_kg;
  double acted_n = 0.0;
  for (std::int64_t n = 0; n < (run.periods + 1) * period; ++n) {
    const signal::MotionSample motion = run.motion->at(n);
    rig::RigInput input;
    input.command_valid = true;
    input.command_position_m = motion.pos_m;
    input.command_velocity_m_s = motion.vel_m_s;
    input.command_acceleration_m_s2 = motion.accel_m_s2;
    input.pegged = run.pegged;
    input.motor_permitted = run.force != nullptr;
    input.motor_valid = run.force != nullptr;
    input.motor_force_n = run.force != nullptr ? run.force->at(n).accel_m_s2 : 0.0;
    rig::RigOutput now = rig.sample(input);
    const double before_n = acted_n;
    rig.drive(input, now);
    acted_n = now.truth.motor_force_n;
    const sensing::Sensed sensed = conditioner.step(device_sample_at(now.raw, n));
    const double displacement_m = of_angle.step(run.rig.stick.lever_m * sensed.theta_rad);
    const double motor_n = of_motor.step(0.5 * (before_n + acted_n));
    const double half_step_n = of_step.step(-0.5 * share * (acted_n - before_n));
    if (n < period || n % kEvery != 0) continue;
    out.record.motor_force_n.push_back(motor_n);
    out.record.acceleration_m_s2.push_back(sensed.accel_y_m_s2);
    out.record.displacement_m.push_back(displacement_m);
    out.record.hand_force_n.push_back(sensed.force_n + (run.mean_of_tick ? half_step_n : 0.0));
    out.held_force_n.push_back(now.truth.feedthrough_force_n);
  }
  return out;
}

admittance::ArmValues arm_of(const rig::RigConfig& config, bool pegged) {
  const rig::ChainParameters p = rig::chain_parameters(config.body, config.stick, pegged);
  const rig::NeuromuscularConfig& nerves = config.body.neuromuscular;
  return {p.trunk_mass_kg,
          p.seat_damping_n_s_m,
          p.seat_stiffness_n_m,
          p.arm_mass_kg,
          p.shoulder_damping_n_s_m,
          p.shoulder_stiffness_n_m,
          p.cell_mass_kg,
          p.grip_damping_n_s_m,
          p.grip_stiffness_n_m,
          pegged ? 0.0 : nerves.reflex_stiffness_n_m,
          pegged ? 0.0 : nerves.reflex_damping_n_s_m,
          nerves.reflex_delay_s,
          nerves.reflex_muscle_hz};
}

admittance::StickValues stick_of(const rig::StickConfig& stick) {
  return {stick.drive_mass_kg, stick.viscous_damping_n_s_m, stick.centring_stiffness_n_m};
}

}  // namespace stillhand::simulated
