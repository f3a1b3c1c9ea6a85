// SPDX-License-Identifier: Apache-2.0
// No sequence of commands, trials, lost processes, emergency stops and ticks drives the rig's motor
// beyond force, slew or duration, or the platform out of its travel.  The canceller is not trusted:
// its commands are drawn too.  A failure prints seed, step and the shortest sequence that was
// found.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>

#include "services/core/rig/rig.hpp"
#include "services/system/process/interlock.hpp"
#include "tests/support/hostile.hpp"

namespace stillhand::rig::rig_property_test {
namespace {

using support::Broken;
using support::Hostile;

constexpr std::uint64_t kSequences = 60;
constexpr std::size_t kSequenceSteps = 2000;

// What reaches the rig's process before one of its ticks.
struct PropertyStep {
  Tick tick;
  RigInput input;  ///< without motor_permitted, which the interlock decides
  Trial trial;
  bool peers_alive;
  bool stop;

  friend std::ostream& operator<<(std::ostream& out, const PropertyStep& step) {
    const RigInput& in = step.input;
    out << "tick " << step.tick << " trial " << step.trial.number
        << (step.peers_alive ? " alive" : "") << (step.stop ? " stop" : "");
    if (in.motor_valid) out << " motor " << in.motor_force_n << " N age " << in.motor_age_ticks;
    if (in.operator_valid) out << " operator " << in.operator_force_n << " N";
    if (in.command_valid) out << " platform " << in.command_position_m << " m";
    return out;
  }
};

Trial trial_of(Hostile& draw, std::int64_t number, Tick tick) {
  Trial trial{number, draw.chance(0.8) ? TrialPhase::kTracking : TrialPhase::kPegged,
              tick + static_cast<Tick>(draw.index(50)), static_cast<Tick>(draw.index(800)),
              static_cast<Tick>(draw.index(100))};
  if (draw.worst()) trial.start_tick = draw.tick(tick);
  if (draw.worst()) trial.duration_ticks = draw.tick(tick);
  if (draw.worst()) trial.phase = TrialPhase::kIdle;
  // The shell drops a trial that is not sound (services/bus/trial_codec.hpp).
  return trial.sound() ? trial : Trial{};
}

RigInput input_of(Hostile& draw, double level_n) {
  RigInput input;
  input.command_valid = !draw.worst();
  input.command_position_m = draw.number(0.1);
  input.command_velocity_m_s = draw.number(0.3);
  input.command_acceleration_m_s2 = draw.number(3.0);
  input.motor_valid = !draw.worst();
  input.motor_age_ticks = draw.tick(static_cast<Tick>(draw.index(3)));
  input.motor_force_n = draw.worst() ? draw.number(100.0) : level_n;
  input.operator_valid = !draw.worst();
  input.operator_age_ticks = draw.tick(1);
  input.operator_force_n = draw.number(80.0);
  return input;
}

std::vector<PropertyStep> steps_of(std::uint64_t seed) {
  Hostile draw(seed);
  std::vector<PropertyStep> steps(kSequenceSteps);
  Trial trial{0, TrialPhase::kTracking, 0, 1500, 10};
  bool alive = true;
  double level_n = 40.0;
  const std::size_t stop_at = draw.chance(0.3) ? draw.index(kSequenceSteps) : kSequenceSteps;
  for (std::size_t n = 0; n < kSequenceSteps; ++n) {
    const auto tick = static_cast<Tick>(n);
    if (draw.chance(0.003)) trial = trial_of(draw, static_cast<std::int64_t>(draw.index(5)), tick);
    if (draw.chance(alive ? 0.001 : 0.05)) alive = !alive;
    if (draw.chance(0.02)) level_n = draw.uniform(-80.0, 80.0);
    steps[n] = {tick, input_of(draw, level_n), trial, alive, n == stop_at};
    steps[n].input.pegged = trial.phase == TrialPhase::kPegged && trial.covers(tick);
  }
  return steps;
}

RigConfig config_of(std::uint64_t seed) {
  Hostile draw(seed ^ 0x5eedu);
  RigConfig config;
  if (seed % 2 == 0) return config;
  config.motor.limits = {draw.uniform(0.0, 60.0), draw.uniform(1.0, 20'000.0),
                         static_cast<std::int64_t>(1 + draw.index(50))};
  config.motor.gain = draw.uniform(0.0, 2.0);
  config.motor.delay_s = draw.uniform(0.0, 0.2);
  config.motor.lag_s = draw.uniform(0.0002, 0.02);
  config.motor.max_motor_age_ticks = static_cast<std::int64_t>(1 + draw.index(100));
  return config;
}

// The rule of ARCHITECTURE.md, "Interlock", written down a second time.
class Permission {
 public:
  bool at(const PropertyStep& step) {
    if (step.trial.number != number_) {
      number_ = step.trial.number;
      lost_ = false;
    }
    stopped_ = stopped_ || step.stop;
    const bool runs = step.trial.covers(step.tick);
    lost_ = lost_ || (runs && !step.peers_alive);
    return runs && !lost_ && !stopped_;
  }

 private:
  std::int64_t number_ = -2;
  bool lost_ = false;
  bool stopped_ = false;
};

bool usable(const RigInput& input, const RigConfig& config) {
  return input.motor_valid && input.motor_age_ticks >= 0 &&
         input.motor_age_ticks <= config.motor.max_motor_age_ticks &&
         std::isfinite(input.motor_force_n);
}

std::optional<std::string> not_finite(const RigOutput& out) {
  const RigTruth& t = out.truth;
  const std::array values{
      t.platform_position_m, t.platform_velocity_m_s, t.platform_acceleration_m_s2, t.theta_rad,
      t.omega_rad_s,         t.feedthrough_force_n,   t.volitional_force_n,         t.hand_force_n};
  const bool finite = std::ranges::all_of(values, [](double v) { return std::isfinite(v); });
  return finite ? std::nullopt : std::optional<std::string>("an output is not finite");
}

struct Watched {
  std::optional<Broken> broken;
  double largest_n = 0.0;
};

Watched watched(std::uint64_t seed, const std::vector<PropertyStep>& steps) {
  const RigConfig config = config_of(seed);
  // Every third rig holds an undeclared effect; some of them act on the motor.
  Rig sut(config, seed % 3 == 0 ? SealedEffect(seed, config) : SealedEffect());
  runtime::Interlock interlock;
  Permission permission;
  support::ForceWatch watch(config.motor.limits.max_force_n, config.motor.limits.max_slew_n_s,
                            config.motor.limits.ramp_ticks);
  for (std::size_t n = 0; n < steps.size(); ++n) {
    const PropertyStep& step = steps[n];
    if (step.stop) interlock.stop();
    RigInput input = step.input;
    input.motor_permitted = interlock.step(step.trial, step.tick, step.peers_alive);
    const RigOutput out = sut.step(input);
    const bool allowed = permission.at(step) && usable(input, config);
    auto what = watch.see(out.truth.motor_force_n, allowed);
    if (!what) what = not_finite(out);
    // Stops within the travel; 1e-9 m for the last bits.
    if (!what && std::abs(out.truth.platform_position_m) > config.platform.workspace_m + 1e-9) {
      what = "platform outside its travel";
    }
    if (what) return {Broken{n, *what}, watch.largest_n()};
  }
  return {std::nullopt, watch.largest_n()};
}

TEST(RigPropertyTest, NoSequenceDrivesTheMotorBeyondForceSlewOrDuration) {
  int at_limit = 0;
  for (std::uint64_t seed = 1; seed <= kSequences; ++seed) {
    const auto steps = steps_of(seed);
    const Watched seen = watched(seed, steps);
    ASSERT_FALSE(seen.broken.has_value()) << support::failure_of<PropertyStep>(
        seed, steps, [&](const auto& part) { return watched(seed, part).broken; });
    if (seen.largest_n > 0.99 * config_of(seed).motor.limits.max_force_n) ++at_limit;
  }
  // Sequences without a force would show nothing.
  EXPECT_GT(at_limit, static_cast<int>(kSequences) / 4);
}

}  // namespace
}  // namespace stillhand::rig::rig_property_test
