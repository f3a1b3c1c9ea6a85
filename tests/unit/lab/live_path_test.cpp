// SPDX-License-Identifier: Apache-2.0
// A mitigation on the path of a live session, through the messages of the bus, next to the study's
// trial: assignment to parts to mitigation, motor command to display, whose angle is a tick late.
// A second of processor time.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "apps/lab/codec.hpp"
#include "apps/libraries/session/loop.hpp"
#include "apps/study/mitigations/mitigated_trial.hpp"
#include "services/core/cancellation/parts/recipe.hpp"
#include "services/core/human_operator/crossover_operator.hpp"
#include "services/core/motion/motion_generator.hpp"
#include "services/core/population/task.hpp"
#include "services/messages/cancellation/codec.hpp"
#include "services/messages/display/codec.hpp"

namespace stillhand::lab::live_path_test {
namespace {

using session::Condition;
using study::run_mitigated;
using study::TrialScene;

// Feedthrough of an idle hand, roughly: -3.2 N per m/s^2; to position over a stiff arm.
const signal::DifferenceModel kForce{1000.0, {-3.2}, {1.0}};
const signal::DifferenceModel kPosition{1000.0, {-3.2 / 1136.0}, {1.0}};

TrialScene scene() {
  TrialScene out;
  out.subject = population::draw_subject({}, 5, 3);
  out.duration_ticks = 12'000;
  out.settle_ticks = 4'000;
  out.motion =
      study::trial_motion(study::TrialMotion::kBand, out.duration_ticks, out.ramp_ticks, 9);
  return out;
}

stillhand_msgs::Sensed message_of(const sensing::Sensed& sensed, Tick tick) {
  stillhand_msgs::Sensed out;
  out.tick(tick);
  out.accel_x_m_s2(sensed.accel_x_m_s2);
  out.accel_y_m_s2(sensed.accel_y_m_s2);
  out.accel_z_m_s2(sensed.accel_z_m_s2);
  out.roll_rad(sensed.roll_rad);
  out.theta_rad(sensed.theta_rad);
  out.omega_rad_s(sensed.omega_rad_s);
  out.flags(sensed.flags);
  return out;
}

cancellation::Recipe over_the_bus(Condition condition) {
  session::ProtocolOptions options;
  options.trial_s = 12.0;
  auto recipe = recipe_of(
      cancellation::parts_of(assignment_of(session::tracking_trial(options, condition, 1))),
      kPosition, {});
  recipe.model = cancellation::control_model(kForce);
  return recipe;
}

// RMS error [mm] behind the settled part.
double live_error_mm(const TrialScene& scene, const cancellation::Recipe& recipe) {
  rig::RigConfig rig;
  rig.body = scene.subject.body;
  rig.seed = static_cast<std::int64_t>(scene.rig_seed);
  session::Loop loop(rig, {});
  human_operator::CrossoverConfig who = scene.subject.who;
  who.seed = rig.seed;
  who.arm = population::learnt_feel(rig.body, {}, who.arm);
  for (const cancellation::Part& part : recipe.parts) {
    if (part.kind == cancellation::PartKind::kImpedance) {
      who.arm.effective_damping_n_s_m += part.values[1];
    }
  }
  human_operator::CrossoverOperator person(who);
  cancellation::Countermeasure mitigated({}, recipe);
  display::TrackingDisplay screen(display::TrackingDisplay::Config{});
  display::CommandInUse command;
  motion::MotionGenerator platform(motion::MotionGenerator::Config{});
  const Trial trial{scene.number, TrialPhase::kTracking, scene.ramp_ticks + 1, scene.duration_ticks,
                    scene.ramp_ticks};
  platform.arm(motion::MotionTrajectory(scene.motion), trial);
  screen.arm(trial, scene.reference_seed);
  person.arm(trial);
  double operator_n = 0.0;
  double sum = 0.0;
  const Tick end = trial.start_tick + trial.duration_ticks;
  for (Tick tick = 1; tick < end; ++tick) {
    const bool covered = trial.covers(tick);
    display::TrackingSample shown{};
    const session::Turn turn{
        .command = platform.step(tick), .operator_force_n = operator_n, .permitted = covered};
    const auto turned = loop.turn(tick, turn, [&](const sensing::Sensed& sample) {
      const auto sensed = message_of(sample, tick);
      // The display has the sample before cancellation's answer to it.
      shown = screen.step(display::from_idl(sensed, command.at(tick)));
      const auto input = cancellation::from_idl(sensed, covered, covered);
      const auto answer = cancellation::to_idl(mitigated.step(input), input, sensed, -1, 1);
      command.offer(display::from_idl(answer));
      return answer.force_n();
    });
    const double accel_y_m_s2 = turned.sensed.accel_y_m_s2;
    operator_n = person.step({tick, shown.target_m, shown.cursor_m, covered, accel_y_m_s2}).force_n;
    if (tick < trial.start_tick + scene.settle_ticks) continue;
    const double error_m = shown.cursor_m - shown.target_m;
    sum += error_m * error_m;
  }
  return 1000.0 * std::sqrt(sum / static_cast<double>(scene.duration_ticks - scene.settle_ticks));
}

// At 2 Hz a tick is 0.013 rad: 1.3 % of what is taken off the command, which is at most the motion
// of B. Of the error of B, 2 %.
TEST(LivePathTest, TheBusCostsATickOfTheCommandAndNothingOfTheForce) {
  const TrialScene trial = scene();
  const double without_mm = run_mitigated(trial, {}, false).error_mm;
  for (const Condition condition : {Condition::kLowPass, Condition::kNotch, Condition::kModelFilter,
                                    Condition::kSignal, Condition::kLmsSignal}) {
    const cancellation::Recipe recipe = over_the_bus(condition);
    const double live_mm = live_error_mm(trial, recipe);
    const double study_mm = run_mitigated(trial, recipe, false).error_mm;
    std::cout << name_of(condition) << ": " << live_mm << " mm, in the study " << study_mm
              << ", without " << without_mm << '\n';
    EXPECT_NEAR(live_mm, study_mm, 0.02 * without_mm) << name_of(condition);
  }
  // A force is used in the tick of its sample: to the bit.
  for (const Condition condition : {Condition::kAdaptive, Condition::kLmsForce, Condition::kDamping,
                                    Condition::kDampingForce}) {
    const cancellation::Recipe recipe = over_the_bus(condition);
    EXPECT_DOUBLE_EQ(live_error_mm(trial, recipe), run_mitigated(trial, recipe, false).error_mm)
        << name_of(condition);
  }
}

}  // namespace
}  // namespace stillhand::lab::live_path_test
