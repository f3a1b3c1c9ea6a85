// SPDX-License-Identifier: Apache-2.0
// How long one step of each core in the control loop takes, alone:
//   build/tests/step_cost --benchmark_repetitions=5 --benchmark_report_aggregates_only
#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>

#include "services/core/rig/rig.hpp"
#include "services/core/sensing/conditioner.hpp"

namespace stillhand {
namespace {

/// 1.2 Hz, 1.6 m/s^2 RMS: the tracking motion's size.
rig::RigInput moving(Tick tick) {
  const double rate_rad_s = 2.0 * std::numbers::pi * 1.2;
  const double phase_rad = rate_rad_s * static_cast<double>(tick) * kControlPeriod_s;
  constexpr double kAmplitude_m = 0.04;
  rig::RigInput input;
  input.command_valid = true;
  input.command_position_m = kAmplitude_m * std::sin(phase_rad);
  input.command_velocity_m_s = kAmplitude_m * rate_rad_s * std::cos(phase_rad);
  input.command_acceleration_m_s2 = -kAmplitude_m * rate_rad_s * rate_rad_s * std::sin(phase_rad);
  input.motor_valid = true;
  input.motor_force_n = std::sin(phase_rad);
  input.motor_permitted = true;
  input.operator_valid = true;
  input.operator_force_n = std::cos(phase_rad);
  return input;
}

void step_rig(benchmark::State& state, const rig::RigConfig& config) {
  rig::Rig core(config);
  Tick tick = 0;
  for (auto _ : state) benchmark::DoNotOptimize(core.step(moving(tick++)));
}

void rig_step(benchmark::State& state) { step_rig(state, {}); }
void rig_step_without_nerves(benchmark::State& state) {
  rig::RigConfig config;
  config.body.neuromuscular.wander = 0.0;
  config.body.neuromuscular.involuntary_force_n = 0.0;
  config.body.neuromuscular.tremor_force_n = 0.0;
  config.body.neuromuscular.unmeasured_force_n_s2_m = 0.0;
  step_rig(state, config);
}

/// What the rig's steps above spend on their own input.
void input_alone(benchmark::State& state) {
  Tick tick = 0;
  for (auto _ : state) benchmark::DoNotOptimize(moving(tick++));
}

void sensing_step(benchmark::State& state) {
  sensing::Conditioner core(sensing::Config{});
  sensing::DeviceSample sample{};
  for (auto _ : state) {
    ++sample.tick;
    sample.accel_y_v = 0.01 * static_cast<double>(sample.tick % 100);
    benchmark::DoNotOptimize(core.step(sample));
  }
}

BENCHMARK(rig_step);
BENCHMARK(rig_step_without_nerves);
BENCHMARK(input_alone);
BENCHMARK(sensing_step);

}  // namespace
}  // namespace stillhand

BENCHMARK_MAIN();
