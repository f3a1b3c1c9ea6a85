// SPDX-License-Identifier: Apache-2.0
// Eq. SN-8 to SN-10 on a session whose stalls, limits and noise are known.
#include "apps/libraries/session/force_budget.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <vector>

#include "apps/libraries/session/in_process.hpp"
#include "apps/libraries/session/on_time.hpp"
#include "services/messages/cancellation/codec.hpp"
#include "services/messages/rig/codec.hpp"
#include "services/messages/sensing/codec.hpp"

namespace stillhand::session {
namespace {

constexpr Tick kStart = 6000, kLength = 30000;

/// Static model: its force follows the acceleration.
cancellation::ControlModel model(double gain_n_s2_m) {
  return cancellation::control_model({kControlRateHz, {gain_n_s2_m}, {1.0}});
}

struct Made {
  SessionRecording session;
  PlannedTrial planned{};
  std::vector<double> feedthrough_n, motor_n;
};

struct Faults {
  Tick stall_ticks = 0;          ///< in each second the canceller stands still so long
  double max_force_n = 25.0;     ///< its limit
  double involuntary_n = 0.0;    ///< of the body
  double accel_noise = 0.00108;  ///< [(m/s^2)/sqrt(Hz)]
};

AnswerConfigs configs_of(const Faults& faults) {
  AnswerConfigs configs;
  configs.cancellation.limits.max_force_n = faults.max_force_n;
  return configs;
}

/// Three sines of 1.2 m/s^2.
void move(rig::RigInput& input, double time_s) {
  input.command_valid = true;
  input.command_position_m = input.command_velocity_m_s = input.command_acceleration_m_s2 = 0.0;
  for (const double frequency_hz : {0.7, 1.1, 1.7}) {
    const double rate_rad_s = 2.0 * std::numbers::pi * frequency_hz;
    const double part_m_s2 = 1.2 * std::sin(rate_rad_s * time_s + frequency_hz);
    input.command_acceleration_m_s2 += part_m_s2;
    input.command_velocity_m_s -= 1.2 / rate_rad_s * std::cos(rate_rad_s * time_s + frequency_hz);
    input.command_position_m -= part_m_s2 / (rate_rad_s * rate_rad_s);
  }
}

/// Rig, conditioner and canceller, with what the processes write; one seed for all.
Made made(const Faults& faults) {
  Made made;
  made.planned.trial = {1, TrialPhase::kTracking, kStart, kLength, 2000};
  made.planned.cancellation = true;
  const AnswerConfigs configs = configs_of(faults);
  rig::RigConfig config;
  config.sensors.accel_noise_m_s2_rthz = faults.accel_noise;
  config.body.neuromuscular = {.involuntary_force_n = faults.involuntary_n};
  rig::Rig rig(config);
  sensing::Conditioner conditioner(configs.sensing);
  cancellation::Countermeasure canceller(configs.cancellation, {.force = true});
  EXPECT_EQ(canceller.load_model(model(-2.0)), cancellation::Refusal::kNone);
  stillhand_msgs::AugmentedModel sent =
      cancellation::to_idl(model(-2.0), cancellation::kFirstControlModel);
  made.session.control_models.push_back(sent);
  rig::RigInput input{};
  Tick answered = 0;
  for (Tick tick = 0; tick < kStart + kLength; ++tick) {
    const bool covered = made.planned.trial.covers(tick);
    move(input, static_cast<double>(tick) * kControlPeriod_s);
    rig::RigOutput out = rig.sample(input);
    const auto raw = rig::to_idl(out, tick);
    made.session.raw_samples.push_back(raw);
    const bool stands = covered && tick % 1000 < faults.stall_ticks;
    if (!stands) {
      const auto sensed = conditioner.step(sensing::from_idl(raw));
      input.motor_force_n = canceller.step(input_of(tick, sensed, covered, covered)).force_n;
      made.session.sensed.push_back(sensing::to_idl(sensed, raw));
      answered = tick;
    }
    input.motor_valid = true;
    input.motor_age_ticks = tick - answered;
    input.motor_permitted = covered;
    rig.drive(input, out);
    made.session.rig_truths.push_back(rig::to_idl(out, tick, input, {tick, answered, -1}));
    if (!made.planned.trial.measures(tick)) continue;
    made.feedthrough_n.push_back(out.truth.feedthrough_force_n);
    made.motor_n.push_back(out.truth.motor_force_n);
  }
  return made;
}

ForceBudget budget_of(const Made& made, const Faults& faults) {
  const auto sut = force_budget(on_time_signals(
      made.session, made.planned, cancellation::kFirstControlModel, configs_of(faults)));
  EXPECT_TRUE(sut);
  return sut.value_or(ForceBudget{});
}

/// Mean of the product of what is left with a part of it, over the RMS of what is left: Eq. SN-8.
double share_n(const Made& made, const std::vector<double>& part_n) {
  double product = 0.0, square = 0.0;
  for (std::size_t n = 0; n < part_n.size(); ++n) {
    const double left_n = made.feedthrough_n[n] + made.motor_n[n];
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

double sum_of(const ForceBudget& budget) {
  return std::accumulate(
      kForceCauses.begin(), kForceCauses.end(), 0.0,
      [&](double sum, const ForceCause& cause) { return sum + (budget.*cause.of).force_n; });
}

TEST(ForceBudgetTest, ASessionWithoutFaultLeavesWhatTheModelLacks) {
  const Faults none;
  const Made session = made(none);
  const ForceBudget sut = budget_of(session, none);
  EXPECT_GT(sut.left.force_n, 0.5);
  EXPECT_NEAR(sut.model.force_n, sut.left.force_n, 0.03 * sut.left.force_n);
  EXPECT_NEAR(sut.lateness.force_n, 0.0, 1e-9);
  EXPECT_NEAR(sut.limits.force_n, 0.0, 0.001);
  EXPECT_NEAR(sum_of(sut), sut.left.force_n, 1e-9);
}

// The same session without the stalls says what they did: f' is the same in both, sample by sample.
TEST(ForceBudgetTest, LatenessIsWhatKnownStallsDid) {
  const Made whole = made({});
  for (const Tick stall : {30, 73, 200}) {
    const Faults faults{.stall_ticks = stall};
    const Made stalled = made(faults);
    ASSERT_EQ(stalled.feedthrough_n, whole.feedthrough_n);
    const double known_n = share_n(stalled, difference(stalled.motor_n, whole.motor_n));
    const ForceBudget sut = budget_of(stalled, faults);
    EXPECT_GT(known_n, 0.01);
    EXPECT_NEAR(sut.lateness.force_n, known_n, 0.05 * known_n) << stall;
    EXPECT_LT(sut.lateness.low_n, known_n) << stall;
    EXPECT_GT(sut.lateness.high_n, known_n) << stall;
    EXPECT_NEAR(sum_of(sut), sut.left.force_n, 1e-9);
  }
}

TEST(ForceBudgetTest, LimitsAreWhatALowLimitDid) {
  const Made whole = made({});
  const Faults faults{.max_force_n = 2.0};
  const Made limited = made(faults);
  const double known_n = share_n(limited, difference(limited.motor_n, whole.motor_n));
  const ForceBudget sut = budget_of(limited, faults);
  EXPECT_GT(known_n, 0.1);
  EXPECT_NEAR(sut.limits.force_n, known_n, 0.05 * known_n);
  EXPECT_NEAR(sut.lateness.force_n, 0.0, 1e-9);
}

// The body's own force is what f' has more than without it.
TEST(ForceBudgetTest, InvoluntaryIsTheBodysOwnForce) {
  const Made without = made({});
  const Faults faults{.involuntary_n = 0.8};
  const Made shaken = made(faults);
  const std::vector<double> own_n = difference(shaken.feedthrough_n, without.feedthrough_n);
  const double known_n = std::inner_product(own_n.begin(), own_n.end(), own_n.begin(), 0.0) /
                         static_cast<double>(own_n.size()) / budget_of(shaken, faults).left.force_n;
  const ForceBudget sut = budget_of(shaken, faults);
  EXPECT_GT(known_n, 0.1);
  EXPECT_LT(sut.involuntary.low_n, known_n);
  EXPECT_GT(sut.involuntary.high_n, known_n);
  EXPECT_NEAR(sut.involuntary.force_n, known_n, 0.2 * known_n);
}

TEST(ForceBudgetTest, ANoisyAccelerometerIsTheSensors) {
  const Faults faults{.accel_noise = 0.05};
  const Made noisy = made(faults), quiet = made({.accel_noise = 0.0});
  const double known_n = share_n(noisy, difference(noisy.motor_n, quiet.motor_n));
  const ForceBudget sut = budget_of(noisy, faults);
  EXPECT_GT(known_n, 0.05);
  EXPECT_NEAR(sut.sensor.force_n, known_n, 0.05 * known_n);
}

TEST(ForceBudgetTest, AnUnknownFeedthroughOrModelHasNone) {
  Made session = made({});
  EXPECT_FALSE(force_budget(on_time_signals(session.session, session.planned, 3, {})));
  session.session.rig_truths[kStart + 7].feedthrough_force_n(NAN);
  EXPECT_FALSE(force_budget(
      on_time_signals(session.session, session.planned, cancellation::kFirstControlModel, {})));
}

}  // namespace
}  // namespace stillhand::session
