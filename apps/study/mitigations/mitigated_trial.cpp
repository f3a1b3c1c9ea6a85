// SPDX-License-Identifier: Apache-2.0
#include "apps/study/mitigations/mitigated_trial.hpp"

#include <cmath>
#include <numbers>

#include "apps/libraries/session/loop.hpp"
#include "apps/libraries/session/protocol.hpp"
#include "apps/study/subjects/subject_session.hpp"
#include "services/core/display/tracking_display.hpp"
#include "services/core/human_operator/crossover_operator.hpp"
#include "services/core/motion/motion_generator.hpp"
#include "services/core/population/task.hpp"
#include "services/core/rig/plant.hpp"
#include "services/core/signal/butterworth.hpp"
#include "services/core/signal/random.hpp"
#include "services/core/signal/second_order_lag.hpp"

namespace stillhand::study {
namespace {

rig::BodyConfig body_of(const TrialScene& scene, bool arm_rest) {
  rig::BodyConfig body = scene.subject.body;
  if (scene.task == TrialTask::kRelax) body = doing(body, population::Task::kRelax);
  if (scene.task == TrialTask::kHold) body = doing(body, population::Task::kHold);
  if (arm_rest) {
    const StudyOptions condition_f;
    body.arm_rest_stiffness_n_m = condition_f.arm_rest_stiffness_n_m;
    body.arm_rest_damping_n_s_m = condition_f.arm_rest_damping_n_s_m;
  }
  return body;
}

// Each person practised with the stick as it is in the trial (paper III-C), the motor's impedance
// included.
human_operator::CrossoverConfig who_of(const TrialScene& scene, const rig::BodyConfig& body,
                                       const cancellation::Recipe& recipe) {
  human_operator::CrossoverConfig who = scene.subject.who;
  who.seed = static_cast<std::int64_t>(scene.rig_seed & 0xffffffffu);
  who.arm = population::learnt_feel(body, {}, who.arm);
  for (const cancellation::Part& part : recipe.parts) {
    if (part.kind != cancellation::PartKind::kImpedance) continue;
    who.arm.effective_stiffness_n_m += part.values[0];
    who.arm.effective_damping_n_s_m += part.values[1];
    who.arm.effective_mass_kg += part.values[2];
  }
  return who;
}

}  // namespace

TrialFigures run_mitigated(const TrialScene& scene, const cancellation::Recipe& recipe,
                           bool arm_rest) {
  const bool tracks = scene.task == TrialTask::kTrack;
  rig::RigConfig rig;
  rig.body = body_of(scene, arm_rest);
  session::Loop loop(rig::seeded(rig, scene.rig_seed), {});
  cancellation::Countermeasure mitigated({}, recipe);
  human_operator::CrossoverOperator person(who_of(scene, rig.body, recipe));
  display::TrackingDisplay screen(display::TrackingDisplay::Config{});
  motion::MotionGenerator platform(motion::MotionGenerator::Config{});
  Trial trial;
  trial.number = scene.number;
  trial.phase = TrialPhase::kTracking;
  trial.start_tick = scene.ramp_ticks + 1;
  trial.duration_ticks = scene.duration_ticks;
  trial.ramp_ticks = scene.ramp_ticks;
  if (scene.motion.duration_ticks() > 0) {
    platform.arm(motion::MotionTrajectory(scene.motion), trial);
  }
  if (tracks) screen.arm(trial, scene.reference_seed);
  person.arm(trial);

  TrialFigures sum;
  std::int64_t count = 0;
  double operator_n = 0.0;
  const Tick end = trial.start_tick + trial.duration_ticks;
  for (Tick tick = 1; tick < end; ++tick) {
    const bool covered = trial.covers(tick);
    cancellation::CountermeasureOutput done{};
    const auto [sensed, truth] = loop.turn(
        tick,
        {.command = platform.step(tick), .operator_force_n = operator_n, .permitted = covered},
        [&](const sensing::Sensed& sample) {
          done = mitigated.step(session::input_of(tick, sample, covered, covered));
          return done.force_n;
        });
    const display::TrackingSample shown = screen.step({tick, done.command_rad});
    operator_n =
        person.step({tick, shown.target_m, shown.cursor_m, covered && tracks, sensed.accel_y_m_s2})
            .force_n;
    if (tick < trial.start_tick + scene.settle_ticks) continue;
    const double error_m = shown.cursor_m - shown.target_m;
    sum.error_mm += error_m * error_m;
    sum.motor_n += truth.motor_force_n * truth.motor_force_n;
    sum.effort_n += truth.volitional_force_n * truth.volitional_force_n;
    sum.weight += mitigated.schedule_weight();
    ++count;
  }
  const auto n = static_cast<double>(count);
  return {1000.0 * std::sqrt(sum.error_mm / n), std::sqrt(sum.motor_n / n),
          std::sqrt(sum.effort_n / n), sum.weight / n};
}

std::vector<double> made_ride(double length_s, std::uint64_t seed) {
  // Eq. SU-17.
  constexpr double kSway_hz = 1.4;
  constexpr double kSwayDamping = 0.3;
  constexpr double kSway_m_s2 = 1.2;
  constexpr double kRoughnessTime_s = 8.0;
  constexpr double kRoughness = 0.5;
  constexpr double kCurves_hz = 0.15;
  constexpr double kCurves_m_s2 = 0.8;
  constexpr double kSettle_s = 20.0;
  constexpr double kPeriod_s = 1.0 / kMadeRide_hz;
  signal::Gaussian draw(seed, 0x72696465u);
  signal::SecondOrderLag sway(2.0 * std::numbers::pi * kSway_hz, kSwayDamping, kPeriod_s);
  signal::Butterworth curves(2, kCurves_hz, kMadeRide_hz);
  // White noise of this deviation a sample leaves the lag with 1 m/s^2 RMS: its power is
  // w/(4 z) times the density, 2 s^2 T one-sided.
  const double of_sway =
      kSway_m_s2 / std::sqrt(2.0 * std::numbers::pi * kSway_hz / (4.0 * kSwayDamping) * kPeriod_s);
  // Butterworth of order 2: 1.11 times its corner as noise bandwidth, of 50 Hz.
  const double of_curves = kCurves_m_s2 / std::sqrt(1.11 * kCurves_hz / (0.5 * kMadeRide_hz));
  double roughness = 0.0;
  const double keeps = std::exp(-kPeriod_s / kRoughnessTime_s);
  std::vector<double> out;
  const auto settle = static_cast<std::int64_t>(kSettle_s * kMadeRide_hz);
  const auto samples = static_cast<std::int64_t>(std::ceil(length_s * kMadeRide_hz)) + 1;
  for (std::int64_t n = -settle; n < samples; ++n) {
    roughness = keeps * roughness + kRoughness * std::sqrt(1.0 - keeps * keeps) * draw();
    // exp(r) has the mean square exp(2 var r).
    const double rough = std::exp(roughness - kRoughness * kRoughness);
    const double value = sway.step(of_sway * rough * draw()).x + curves.step(of_curves * draw());
    if (n >= 0) out.push_back(value);
  }
  return out;
}

motion::MotionTrajectory trial_motion(TrialMotion motion, Tick duration_ticks, Tick ramp_ticks,
                                      std::uint64_t seed) {
  session::ProtocolOptions protocol;
  protocol.trial_s = static_cast<double>(duration_ticks) * kControlPeriod_s;
  protocol.ramp_s = static_cast<double>(ramp_ticks) * kControlPeriod_s;
  protocol.seed = seed;
  protocol.motion = motion == TrialMotion::kBand   ? motion::MotionKind::kBandNoise
                    : motion == TrialMotion::kRoad ? motion::MotionKind::kRoad
                                                   : motion::MotionKind::kRide;
  motion::MotionProfile profile =
      motion_profile(tracking_trial(protocol, session::Condition::kB, 1));
  profile.road_class = protocol.road_class;
  profile.road_speed_m_s = protocol.road_speed_m_s;
  if (motion == TrialMotion::kRide) {
    profile.ride_rate_hz = kMadeRide_hz;
    profile.ride_accel_m_s2 = made_ride(protocol.trial_s, seed);
  }
  return {profile, {}};
}

}  // namespace stillhand::study
