// SPDX-License-Identifier: Apache-2.0
// The signals that a trial in one process keeps, and the bounds that each of its ticks keeps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "apps/libraries/session/in_process.hpp"
#include "services/core/signal/moments.hpp"

namespace stillhand::session::in_process_signals_test {
namespace {

constexpr double kShortTrial_s = 5.0;
constexpr std::size_t kTrial_ticks = 5000;

PlannedTrial planned(const std::string& condition, std::uint64_t seed = 1) {
  ProtocolOptions options;
  options.conditions = parse_conditions(condition, kStudyConditions);
  options.trial_s = kShortTrial_s;
  options.identify_s = kShortTrial_s;
  options.seed = seed;
  return plan(options).at(1);
}

PlannedTrial pegged(std::uint64_t seed = 1) {
  ProtocolOptions options;
  options.conditions = parse_conditions("A");
  options.identify_s = kShortTrial_s;
  options.seed = seed;
  return plan(options).at(0);
}

// 3.2 N per m/s^2 against the acceleration, at once: about what a body feeds through at rest.
identification::FeedthroughModel static_model(double gain = -3.2) {
  identification::FeedthroughModel model;
  model.control = {1000.0, {gain, 0.0}, {1.0, 0.0}};
  return model;
}

TEST(CancelledShareTest, IsOneForAFullCounterforceAndNoneWithoutAMotor) {
  std::mt19937_64 engine(101);
  std::normal_distribution<double> any(0.0, 3.0);
  std::vector<double> force(500);
  for (double& f : force) f = any(engine);
  std::vector<double> motor(force.size(), 0.0);
  EXPECT_EQ(cancelled_share(force, motor), 0.0);
  // Of 5 in squares the root of 1 + 4 is left.
  EXPECT_DOUBLE_EQ(cancelled_share({3.0, 4.0}, {-2.0, -6.0}), 1.0 - std::sqrt(5.0 / 25.0));
  for (const double share : {0.3, 0.75, 1.0, 2.0, -1.0}) {
    for (std::size_t n = 0; n < force.size(); ++n) motor[n] = -share * force[n];
    EXPECT_NEAR(cancelled_share(force, motor), 1.0 - std::abs(1.0 - share), 1e-12) << share;
  }
}

TEST(InProcessSignalsTest, APeggedTrialKeepsEveryMeasuredTick) {
  InProcessLoop sut({}, 1, 10);
  const TrialSignals signals = sut.run(pegged());
  EXPECT_EQ(signals.pegged.rate_hz, 1000.0);
  EXPECT_EQ(signals.pegged.acceleration_m_s2.size(), kTrial_ticks);
  EXPECT_EQ(signals.pegged.force_n.size(), kTrial_ticks);
  EXPECT_TRUE(signals.tracking.target_m.empty());
  EXPECT_TRUE(signals.measured.columns.empty());
}

// The loop is the same whatever is kept of it.
TEST(InProcessSignalsTest, KeepingEveryTenthTickKeepsTheSameSamples) {
  InProcessLoop every({}, 7, 1);
  InProcessLoop tenth({}, 7, 10);
  const TrialSignals all = every.run(planned("B", 7));
  const TrialSignals sut = tenth.run(planned("B", 7));
  EXPECT_EQ(sut.tracking.rate_hz, 100.0);
  ASSERT_EQ(all.tracking.cursor_m.size(), kTrial_ticks);
  ASSERT_EQ(sut.tracking.cursor_m.size(), kTrial_ticks / 10);
  ASSERT_EQ(sut.feedthrough_n.size(), kTrial_ticks / 10);
  ASSERT_EQ(sut.weights.size(), kTrial_ticks / 10);
  for (std::size_t n = 0; n < kTrial_ticks / 10; ++n) {
    ASSERT_EQ(sut.tracking.cursor_m[n], all.tracking.cursor_m[10 * n]) << n;
    ASSERT_EQ(sut.tracking.target_m[n], all.tracking.target_m[10 * n]) << n;
    ASSERT_EQ(sut.feedthrough_n[n], all.feedthrough_n[10 * n]) << n;
  }
}

TEST(InProcessSignalsTest, TheMeasuredTableHasARowATickAndAColumnASignal) {
  InProcessLoop sut({}, 3);
  sut.keep_measured();
  const recording::Recording idle = sut.run(pegged(3)).measured;
  EXPECT_EQ(idle.row_count(), kTrial_ticks);
  EXPECT_EQ(idle.find("x_r"), nullptr);
  const TrialSignals signals = sut.run(planned("B", 3));
  const recording::Recording& table = signals.measured;
  ASSERT_EQ(table.row_count(), kTrial_ticks);
  for (const recording::Column& column : table.columns) {
    ASSERT_EQ(column.values.size(), kTrial_ticks) << column.name;
    for (const double value : column.values) ASSERT_TRUE(std::isfinite(value)) << column.name;
  }
  EXPECT_EQ(table.find("x_r")->values, signals.tracking.target_m);
  EXPECT_EQ(table.find("x_p")->values, signals.tracking.cursor_m);
  // Ticks continue from trial to trial.  The first one, of 2 + 5 + 2 s, ends one tick after its
  // ramp, and the second one's ramp of 2 s begins one tick after that.
  EXPECT_DOUBLE_EQ(table.time_s.front(), 11.002);
  for (std::size_t n = 1; n < kTrial_ticks; ++n) {
    ASSERT_NEAR(table.time_s[n] - table.time_s[n - 1], 0.001, 1e-12);
  }
}

// Defaults of the force envelope: 25 N, 2000 N/s.  A model ten times too strong reaches both.
TEST(InProcessSignalsTest, TheMotorStaysWithinForceAndSlewWhateverTheModelAsksFor) {
  for (const double gain : {-3.2, -15.0, 15.0}) {
    InProcessLoop sut({}, 5);
    if (sut.use_model(static_model(gain)) != cancellation::Refusal::kNone) continue;
    const TrialSignals signals = sut.run(planned("C", 5));
    double largest_n = 0.0;
    double steepest_n = 0.0;
    for (std::size_t n = 1; n < signals.motor_n.size(); ++n) {
      largest_n = std::max(largest_n, std::abs(signals.motor_n[n]));
      steepest_n = std::max(steepest_n, std::abs(signals.motor_n[n] - signals.motor_n[n - 1]));
    }
    EXPECT_GT(largest_n, 1.0) << gain;
    EXPECT_LE(largest_n, 25.0) << gain;
    EXPECT_LE(steepest_n, 2.0 + 1e-12) << gain;
  }
}

TEST(InProcessSignalsTest, WithoutAModelConditionCHasNoForce) {
  InProcessLoop sut({}, 6);
  const TrialSignals signals = sut.run(planned("C", 6));
  EXPECT_EQ(std::ranges::count(signals.motor_n, 0.0), static_cast<std::ptrdiff_t>(kTrial_ticks));
}

TEST(InProcessSignalsTest, ARefusedModelLeavesTheOneInUse) {
  const auto run_with = [](const std::vector<identification::FeedthroughModel>& models) {
    InProcessLoop loop({}, 8);
    for (const auto& model : models) (void)loop.use_model(model);
    return loop.run(planned("C", 8)).motor_n;
  };
  identification::FeedthroughModel unstable;
  unstable.control = {1000.0, {1.0, 0.0}, {1.0, -1.01}};
  identification::FeedthroughModel slow = static_model();
  slow.control.rate_hz = 50.0;
  identification::FeedthroughModel broken = static_model(std::nan(""));
  InProcessLoop sut({}, 8);
  EXPECT_EQ(sut.use_model(unstable), cancellation::Refusal::kUnstable);
  EXPECT_EQ(sut.use_model(slow), cancellation::Refusal::kWrongRate);
  EXPECT_EQ(sut.use_model(broken), cancellation::Refusal::kNotFinite);
  EXPECT_EQ(run_with({static_model(), unstable, slow, broken}), run_with({static_model()}));
}

TEST(InProcessSignalsTest, TwoTargetsOfOnePlanDifferAndTheSameTrialAgainDoesNot) {
  InProcessLoop first({}, 9);
  InProcessLoop again({}, 9);
  EXPECT_EQ(first.run(planned("B", 9)).tracking.target_m,
            again.run(planned("B", 9)).tracking.target_m);
  InProcessLoop other({}, 9);
  EXPECT_NE(first.run(planned("B", 10)).tracking.target_m,
            other.run(planned("B", 9)).tracking.target_m);
}

TEST(InProcessSignalsTest, AStillPlatformFeedsAlmostNothingThrough) {
  CoreConfigs linear;
  linear.rig.body.neuromuscular = {};
  InProcessLoop sut(linear, 11);
  const double still_n = signal::rms(sut.run(planned("A", 11)).feedthrough_n);
  const double moving_n = signal::rms(sut.run(planned("B", 11)).feedthrough_n);
  EXPECT_GT(moving_n, 2.0);
  EXPECT_LT(still_n, 0.01 * moving_n);
}

}  // namespace
}  // namespace stillhand::session::in_process_signals_test
