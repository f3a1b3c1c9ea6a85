// SPDX-License-Identifier: Apache-2.0
#include "tests/support/stalled_session.hpp"

#include <cmath>
#include <numbers>

#include "apps/libraries/session/loop.hpp"
#include "services/messages/cancellation/codec.hpp"
#include "services/messages/rig/codec.hpp"
#include "services/messages/sensing/codec.hpp"

namespace stillhand::tests {
namespace {

/// Static model: its force follows the acceleration.
cancellation::ControlModel static_model(double gain_n_s2_m) {
  return cancellation::control_model({kControlRateHz, {gain_n_s2_m}, {1.0}});
}

/// Three sines of 1.2 m/s^2.
void move(rig::RigInput& input, double time_s, std::uint64_t seed) {
  input.command_valid = true;
  input.command_position_m = input.command_velocity_m_s = input.command_acceleration_m_s2 = 0.0;
  for (const double frequency_hz : {0.7, 1.1, 1.7}) {
    const double rate_rad_s = 2.0 * std::numbers::pi * frequency_hz;
    const double turn_rad = rate_rad_s * time_s + frequency_hz * static_cast<double>(seed);
    const double part_m_s2 = 1.2 * std::sin(turn_rad);
    input.command_acceleration_m_s2 += part_m_s2;
    input.command_velocity_m_s -= 1.2 / rate_rad_s * std::cos(turn_rad);
    input.command_position_m -= part_m_s2 / (rate_rad_s * rate_rad_s);
  }
}

/// A process stands still: once a second, at another moment of each.
bool stands(Tick tick, const Faults& faults) {
  const auto second = static_cast<std::uint64_t>(tick / 1000);
  const auto from = static_cast<Tick>((second * 7919 + faults.seed * 104'729) % 700);
  return tick % 1000 >= from && tick % 1000 < from + faults.stall_ticks;
}

}  // namespace

session::AnswerConfigs configs_of(const Faults& faults) {
  session::AnswerConfigs configs;
  configs.cancellation.limits.max_force_n = faults.max_force_n;
  return configs;
}

StalledSession stalled_session(const Faults& faults) {
  StalledSession made;
  made.trial = {1, TrialPhase::kTracking, kStalledStart, kStalledLength, 2000};
  const session::AnswerConfigs configs = configs_of(faults);
  rig::RigConfig config;
  config.sensors.accel_noise_m_s2_rthz = faults.accel_noise;
  config.seed = static_cast<std::int64_t>(faults.seed);
  config.body.neuromuscular = {.involuntary_force_n = faults.involuntary_n};
  rig::Rig rig(config);
  sensing::Conditioner conditioner(configs.sensing);
  cancellation::Countermeasure canceller(configs.cancellation, {.force = true});
  canceller.load_model(static_model(-2.0));
  constexpr std::int32_t kModel = cancellation::kFirstControlModel;
  made.recording.control_models.push_back(cancellation::to_idl(static_model(-2.0), kModel));
  rig::RigInput input{};
  Tick answered = 0;
  for (Tick tick = 0; tick < kStalledStart + kStalledLength; ++tick) {
    const bool covered = made.trial.covers(tick);
    move(input, static_cast<double>(tick) * kControlPeriod_s, faults.seed);
    rig::RigOutput out = rig.sample(input);
    auto raw = rig::to_idl(out, tick);
    raw.stamp_ns(tick * 1'000'000);
    made.recording.raw_samples.push_back(raw);
    const bool late = covered && stands(tick, faults);
    if (!late || !faults.of_sensing) {
      const auto sensed = conditioner.step(sensing::from_idl(raw));
      const auto message = sensing::to_idl(sensed, raw);
      made.recording.sensed.push_back(message);
      if (!late) {
        const auto asked = session::input_of(tick, sensed, covered, covered);
        const auto answer = canceller.step(asked);
        made.recording.motor_commands.push_back(
            cancellation::to_idl(answer, asked, message, kModel, 0));
        input.motor_force_n = answer.force_n;
        answered = tick;
      }
    }
    input.motor_valid = true;
    input.motor_age_ticks = tick - answered;
    input.motor_permitted = covered;
    rig.drive(input, out);
    made.recording.rig_truths.push_back(rig::to_idl(out, tick, input, {tick, answered, -1}));
    if (!made.trial.measures(tick)) continue;
    made.feedthrough_n.push_back(out.truth.feedthrough_force_n);
    made.motor_n.push_back(out.truth.motor_force_n);
  }
  return made;
}

double share_n(const StalledSession& session, const std::vector<double>& part_n) {
  double product = 0.0, square = 0.0;
  for (std::size_t n = 0; n < part_n.size(); ++n) {
    const double left_n = session.feedthrough_n[n] + session.motor_n[n];
    product += left_n * part_n[n];
    square += left_n * left_n;
  }
  return product / std::sqrt(square * static_cast<double>(part_n.size()));
}

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> out(a.size());
  for (std::size_t n = 0; n < a.size(); ++n) out[n] = a[n] - b[n];
  return out;
}

}  // namespace stillhand::tests
