// SPDX-License-Identifier: Apache-2.0
#include "apps/vehicle/drive_loop.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "services/contract/config_error.hpp"
#include "services/motion/core/motion_profile.hpp"

namespace stillhand::vehicle {
namespace {

constexpr Tick kRamp_ticks = 1000;
constexpr Tick kTail_ticks = 5000;  // of a drive: its RMS

DriveConfigs seeded(DriveConfigs configs, std::uint64_t seed) {
  configs.rig.seed = static_cast<std::int64_t>(seed & 0xffffffffu);
  return configs;
}

// The paper's identification motion, as in apps/session.
motion::MotionProfile pegged_profile(Tick duration_ticks, std::uint64_t seed) {
  motion::MotionProfile profile;
  profile.kind = motion::MotionKind::kBandNoise;
  profile.seed = seed;
  profile.band_high_hz = 4.0;
  profile.band_order = 4;
  profile.peak_m_s2 = 0.75 * 9.80665;
  profile.rms_m_s2 = profile.peak_m_s2 / 3.8;
  profile.duration_ticks = duration_ticks;
  profile.ramp_ticks = kRamp_ticks;
  return profile;
}

void keep_extremes(const motion::PlatformCommand& next, double theta_rad, DriveOutcome& out) {
  out.farthest_m = std::max(out.farthest_m, std::abs(next.position_m));
  out.fastest_m_s = std::max(out.fastest_m_s, std::abs(next.velocity_m_s));
  out.hardest_m_s2 = std::max(out.hardest_m_s2, std::abs(next.acceleration_m_s2));
  out.shaped = out.shaped || (next.flags & (kWorkspaceLimit | kSaturated)) != 0;
  out.largest_rad = std::max(out.largest_rad, std::abs(theta_rad));
}

// Since when every half wave of the stick passes a bound; 0: the last one does not.
struct Passed {
  double bound_rad;
  Tick since = 0;

  void step(const GrowingOscillation& stick, Tick tick) {
    if (stick.amplitude_rad() >= bound_rad) {
      if (since == 0) since = tick;
    } else if (stick.last_amplitude_rad() < bound_rad) {
      since = 0;
    }
  }
};

}  // namespace

DriveLoop::DriveLoop(DriveConfigs configs, std::uint64_t seed)
    : rig_(seeded(configs, seed).rig),
      conditioner_(configs.sensing),
      countermeasure_(configs.cancellation, {.force = true}),
      driven_(configs.driven),
      floor_rad_(configs.driven.oscillation.floor_rad),
      ceiling_rad_(configs.driven.oscillation.ceiling_rad),
      answers_in_tick_(configs.rig.motor.answers_in_tick()) {}

void DriveLoop::use_model(const identification::FeedthroughModel& model) {
  const auto refusal = countermeasure_.load_model(cancellation::control_model(model.control));
  if (refusal != cancellation::Refusal::kNone) {
    throw ConfigError("identification.model", std::string(cancellation::describe(refusal)),
                      "a model that the canceller accepts");
  }
}

DriveLoop::Now DriveLoop::tick_once(const Asked& asked) {
  const Tick tick = ++tick_;
  rig::RigInput input;
  input.command_valid = true;
  input.command_position_m = asked.command.position_m;
  input.command_velocity_m_s = asked.command.velocity_m_s;
  input.command_acceleration_m_s2 = asked.command.acceleration_m_s2;
  input.motor_valid = true;
  input.motor_age_ticks = 1;
  input.motor_force_n = motor_force_n_;
  input.motor_permitted = asked.permitted;
  input.pegged = asked.pegged;
  rig::RigOutput out = answers_in_tick_ ? rig_.sample(input) : rig_.step(input);
  const sensing::Sensed sensed =
      conditioner_.step({tick, out.raw.accel_x_v, out.raw.accel_y_v, out.raw.accel_z_v,
                         out.raw.load_cell_v, out.raw.encoder_counts, out.raw.roll_rad});
  const auto cancelled =
      countermeasure_.step({tick,
                            {sensed.accel_x_m_s2, sensed.accel_y_m_s2, sensed.accel_z_m_s2,
                             sensed.roll_rad, sensed.theta_rad, sensed.omega_rad_s},
                            sensed.flags,
                            asked.cancel,
                            asked.permitted,
                            {}});
  motor_force_n_ = cancelled.force_n + asked.perturbation_n;
  if (answers_in_tick_) {
    input.motor_age_ticks = 0;
    input.motor_force_n = motor_force_n_;
    rig_.drive(input, out);
  }
  return {sensed, out.truth, asked.command};
}

void DriveLoop::settle(double seconds) {
  for (Tick left = ticks_in(seconds); left > 0; --left) tick_once({last_command_});
}

identification::Record DriveLoop::pegged(double seconds, std::uint64_t seed) {
  const Tick duration = ticks_in(seconds);
  const motion::MotionTrajectory trajectory(pegged_profile(duration, seed), {});
  identification::Record record;
  record.rate_hz = kControlRateHz;
  for (Tick n = 0; n < duration + 2 * kRamp_ticks; ++n) {
    Asked asked;
    asked.command = trajectory.at(n);
    asked.pegged = true;
    const Now now = tick_once(asked);
    if (n < kRamp_ticks || n >= kRamp_ticks + duration) continue;
    record.acceleration_m_s2.push_back(now.sensed.accel_y_m_s2);
    record.force_n.push_back(now.sensed.force_n);
  }
  last_command_ = trajectory.at(duration + 2 * kRamp_ticks);
  settle(2.0);
  return record;
}

FreeStick DriveLoop::free_stick(const admittance::Excitation& excitation, int periods) {
  const Tick period = excitation.motion.samples_per_period();
  motion::PlatformGuard guard{motion::PlatformLimits{}};
  FreeStick out;
  out.record.rate_hz = kControlRateHz;
  std::vector<double> forces;  // of one period: a sum of sines costs more than a tick
  std::vector<signal::MotionSample> motions;
  for (Tick n = 0; n < period; ++n) {
    forces.push_back(excitation.force.at(n).accel_m_s2);
    motions.push_back(excitation.motion.at(n));
  }
  for (Tick n = 0; n < period * (periods + 1); ++n) {
    // Both fade in over half of the period that is not kept.
    const double fade = std::min(2.0 * static_cast<double>(n) / static_cast<double>(period), 1.0);
    const double force = fade * forces[static_cast<std::size_t>(n % period)];
    const signal::MotionSample& moved = motions[static_cast<std::size_t>(n % period)];
    Asked asked;
    asked.command = guard.step(
        {true, {fade * moved.pos_m, fade * moved.vel_m_s, fade * moved.accel_m_s2, kGood}});
    asked.perturbation_n = force;
    asked.permitted = true;
    const Now now = tick_once(asked);
    if (n < period) continue;
    out.record.motor_force_n.push_back(force);
    out.record.acceleration_m_s2.push_back(asked.command.acceleration_m_s2);
    out.record.displacement_m.push_back(now.sensed.theta_rad);
    out.record.hand_force_n.push_back(now.sensed.force_n);
    out.sensed_acceleration_m_s2.push_back(now.sensed.accel_y_m_s2);
  }
  last_command_ = guard.state();
  return out;
}

Trial DriveLoop::next_trial(double seconds) {
  Trial trial;
  trial.number = ++trials_;
  trial.phase = TrialPhase::kTracking;
  trial.duration_ticks = ticks_in(seconds);
  trial.ramp_ticks = kRamp_ticks;
  trial.start_tick = tick_ + kLead_ticks + kRamp_ticks + 1;
  return trial;
}

DriveOutcome DriveLoop::run(double seconds, bool cancel) {
  const Trial trial = next_trial(seconds);
  driven_.arm({}, trial, true);
  ahead_.fill(last_command_);
  DriveOutcome out;
  const Tick last = trial.start_tick + trial.duration_ticks + trial.ramp_ticks;
  double squares = 0.0;
  bool rests = false;
  bool still = false;
  Tick ended = 0;
  Passed floor_passed{floor_rad_};
  Passed ceiling_passed{ceiling_rad_};
  while (tick_ < last && !(rests && still)) {
    const auto slot = static_cast<std::size_t>((tick_ + 1) % kLead_ticks);
    Asked asked;
    asked.command = ahead_[slot];
    // A process that ends the drive opens the interlock; the motor then ramps to zero.
    asked.permitted = trial.covers(tick_ + 1) && !driven_.ended();
    asked.cancel = cancel;
    const Now now = tick_once(asked);
    ahead_[slot] = driven_.step(
        {tick_, now.sensed.theta_rad, (now.sensed.flags & (kInputInvalid | kInputStale)) == 0});
    keep_extremes(ahead_[slot], now.truth.theta_rad, out);
    if (tick_ >= last - trial.ramp_ticks - kTail_ticks && tick_ < last - trial.ramp_ticks) {
      squares += now.truth.theta_rad * now.truth.theta_rad;
    }
    floor_passed.step(driven_.oscillation(), tick_);
    ceiling_passed.step(driven_.oscillation(), tick_);
    if (!driven_.ended()) continue;
    if (!out.ended) {
      out.ended = true;
      ended = tick_;
      out.ended_s = static_cast<double>(ended - trial.start_tick) * kControlPeriod_s;
      out.frequency_hz = driven_.oscillation().frequency_hz();
      const auto periods_since = [&](Tick from) {
        return static_cast<double>(ended - from) * kControlPeriod_s * out.frequency_hz;
      };
      out.periods_from_floor = periods_since(floor_passed.since);
      if (ceiling_passed.since > 0) out.periods_from_ceiling = periods_since(ceiling_passed.since);
    }
    const double since_s = static_cast<double>(tick_ - ended) * kControlPeriod_s;
    if (!rests && asked.command.velocity_m_s == 0.0 && asked.command.flags & kFault) {
      rests = true;
      out.rest_s = since_s;
    }
    if (!still && now.truth.motor_force_n == 0.0 && since_s > 0.0) {
      still = true;
      out.motor_zero_s = since_s;
    }
  }
  last_command_ = ahead_[static_cast<std::size_t>((tick_ + 1) % kLead_ticks)];
  out.minutes = (out.ended ? out.ended_s : seconds) / 60.0;
  out.rms_rad = out.ended ? 0.0 : std::sqrt(squares / static_cast<double>(kTail_ticks));
  return out;
}

}  // namespace stillhand::vehicle
