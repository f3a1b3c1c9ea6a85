// SPDX-License-Identifier: Apache-2.0
#include "apps/vehicle/drive_loop.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "apps/libraries/session/protocol.hpp"
#include "services/core/cancellation/model_check.hpp"
#include "services/core/rig/plant.hpp"

namespace stillhand::vehicle {
namespace {

constexpr Tick kRamp_ticks = 1000;
constexpr Tick kTail_ticks = 5000;  // of a drive: its RMS

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

  void step(const signal::GrowingOscillation& stick, Tick tick) {
    if (stick.amplitude_rad() >= bound_rad) {
      if (since == 0) since = tick;
    } else if (stick.last_amplitude_rad() < bound_rad) {
      since = 0;
    }
  }
};

}  // namespace

DriveLoop::DriveLoop(DriveConfigs configs, std::uint64_t seed)
    : loop_(rig::seeded(configs.rig, seed), configs.sensing),
      countermeasure_(configs.cancellation, {.force = true}),
      driven_(configs.driven),
      floor_rad_(configs.driven.oscillation.floor_rad),
      ceiling_rad_(configs.driven.oscillation.ceiling_rad) {}

void DriveLoop::use_model(const identification::FeedthroughModel& model) {
  require_taken(countermeasure_.load_model(cancellation::control_model(model.control)),
                "identification.model", "a model that the canceller accepts");
}

session::Turned DriveLoop::tick_once(const session::Turn& turn, bool cancel,
                                     double perturbation_n) {
  const Tick tick = ++tick_;
  return loop_.turn(tick, turn, [&](const sensing::Sensed& sensed) {
    const auto input = session::input_of(tick, sensed, cancel, turn.permitted);
    return countermeasure_.step(input).force_n + perturbation_n;
  });
}

void DriveLoop::settle(double seconds) {
  for (Tick left = ticks_in(seconds); left > 0; --left) tick_once({.command = last_command_});
}

identification::Record DriveLoop::pegged(double seconds, std::uint64_t seed) {
  session::ProtocolOptions protocol;
  protocol.identify_s = seconds;
  protocol.ramp_s = static_cast<double>(kRamp_ticks) * kControlPeriod_s;
  session::PlannedTrial planned = session::identification_trial(protocol);
  planned.motion_seed = seed;
  const motion::MotionTrajectory trajectory(session::motion_profile(planned), {});
  const Tick duration = planned.trial.duration_ticks;
  identification::Record record;
  record.rate_hz = kControlRateHz;
  for (Tick n = 0; n < duration + 2 * kRamp_ticks; ++n) {
    const session::Turned now = tick_once({.command = trajectory.at(n), .pegged = true});
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
    session::Turn turn;
    turn.command = guard.step(
        {true, {fade * moved.pos_m, fade * moved.vel_m_s, fade * moved.accel_m_s2, kGood}});
    turn.permitted = true;
    const session::Turned now = tick_once(turn, false, force);
    if (n < period) continue;
    out.record.motor_force_n.push_back(force);
    out.record.acceleration_m_s2.push_back(turn.command.acceleration_m_s2);
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
    session::Turn turn;
    turn.command = ahead_[slot];
    // A process that ends the drive opens the interlock; the motor then ramps to zero.
    turn.permitted = trial.covers(tick_ + 1) && !driven_.ended();
    const session::Turned now = tick_once(turn, cancel);
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
    if (!rests && turn.command.velocity_m_s == 0.0 && turn.command.flags & kFault) {
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
