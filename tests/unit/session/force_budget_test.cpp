// SPDX-License-Identifier: Apache-2.0
// Eq. SN-8 to SN-10 on a session whose stalls, limits and noise are known.
#include "apps/libraries/session/force_budget.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

#include "tests/support/stalled_session.hpp"

namespace stillhand::session::force_budget_test {
namespace {

using tests::configs_of;
using tests::difference;
using tests::Faults;
using tests::kStalledStart;
using tests::share_n;
using tests::stalled_session;
using tests::StalledSession;

// --gtest_random_seed=N: other noise, another motion, stalls at other moments.
StalledSession made(Faults faults) {
  faults.seed = static_cast<std::uint64_t>(1 + GTEST_FLAG_GET(random_seed));
  return stalled_session(faults);
}

ForceBudget budget_of(const StalledSession& made, const Faults& faults) {
  const auto sut = split_trial(made.recording, made.trial, configs_of(faults));
  EXPECT_TRUE(sut.budget) << sut.why;
  return sut.budget.value_or(ForceBudget{});
}

double sum_of(const ForceBudget& budget) {
  return std::accumulate(
      kForceCauses.begin(), kForceCauses.end(), 0.0,
      [&](double sum, const ForceCause& cause) { return sum + (budget.*cause.of).force_n; });
}

TEST(ForceBudgetTest, ASessionWithoutFaultLeavesWhatTheModelLacks) {
  const Faults none;
  const StalledSession session = made(none);
  const ForceBudget sut = budget_of(session, none);
  EXPECT_GT(sut.left.force_n, 0.5);
  EXPECT_NEAR(sut.model.force_n, sut.left.force_n, 0.03 * sut.left.force_n);
  EXPECT_NEAR(sut.lateness.force_n, 0.0, 1e-9);
  EXPECT_NEAR(sut.limits.force_n, 0.0, 0.001);
  EXPECT_NEAR(sum_of(sut), sut.left.force_n, 1e-9);
}

// The same session without the stalls says what they did: f' is the same in both, sample by sample.
TEST(ForceBudgetTest, LatenessIsWhatKnownStallsDid) {
  const StalledSession whole = made({});
  for (const Tick stall : {30, 73, 200}) {
    const Faults faults{.stall_ticks = stall};
    const StalledSession stalled = made(faults);
    ASSERT_EQ(stalled.feedthrough_n, whole.feedthrough_n);
    const double known_n = share_n(stalled, difference(stalled.motor_n, whole.motor_n));
    const ForceBudget sut = budget_of(stalled, faults);
    EXPECT_GT(known_n, 0.0);
    std::printf("stalls of %3d ms a second: %.4f N known, %.4f N (%.4f to %.4f) found\n",
                static_cast<int>(stall), known_n, sut.lateness.force_n, sut.lateness.low_n,
                sut.lateness.high_n);
    EXPECT_NEAR(sut.lateness.force_n, known_n, 0.05 * known_n) << stall;
    EXPECT_LT(sut.lateness.low_n, known_n) << stall;
    EXPECT_GT(sut.lateness.high_n, known_n) << stall;
    EXPECT_NEAR(sum_of(sut), sut.left.force_n, 1e-9);
  }
}

TEST(ForceBudgetTest, LimitsAreWhatALowLimitDid) {
  const StalledSession whole = made({});
  const Faults faults{.max_force_n = 2.0};
  const StalledSession limited = made(faults);
  const double known_n = share_n(limited, difference(limited.motor_n, whole.motor_n));
  const ForceBudget sut = budget_of(limited, faults);
  EXPECT_GT(known_n, 0.1);
  EXPECT_NEAR(sut.limits.force_n, known_n, 0.05 * known_n);
  EXPECT_NEAR(sut.lateness.force_n, 0.0, 1e-9);
}

// The body's own force is what f' has more than without it.
TEST(ForceBudgetTest, InvoluntaryIsTheBodysOwnForce) {
  const StalledSession without = made({});
  const Faults faults{.involuntary_n = 0.8};
  const StalledSession shaken = made(faults);
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
  const StalledSession noisy = made(faults), quiet = made({.accel_noise = 0.0});
  const double known_n = share_n(noisy, difference(noisy.motor_n, quiet.motor_n));
  const ForceBudget sut = budget_of(noisy, faults);
  EXPECT_GT(known_n, 0.05);
  EXPECT_NEAR(sut.sensor.force_n, known_n, 0.05 * known_n);
}

// Eq. SN-8 of f' = 7, f_m = -4, f_o = -5, f_u = -8, f_t = -10 N: 3 N are left.
TEST(ForceBudgetTest, ATickIsSplitIntoItsParts) {
  ForceSums sut = sums_of({7.0, -4.0, {-5.0, -8.0, -10.0}});
  EXPECT_EQ(sut.lateness, 3.0 * 1.0);
  EXPECT_EQ(sut.limits, 3.0 * 3.0);
  EXPECT_EQ(sut.sensor, 3.0 * 2.0);
  EXPECT_EQ(sut.rest, 3.0 * -3.0);
  EXPECT_EQ(sut.left, sut.lateness + sut.limits + sut.sensor + sut.rest);
  for (int i = 0; i < 2; ++i) sut += sut;
  EXPECT_EQ(sut.ticks, 4.0);
  EXPECT_EQ(sut.force_n(sut.left), 3.0);
  EXPECT_EQ(sut.force_n(sut.lateness), 1.0);
  EXPECT_EQ(sut.force_n(sut.limits), 3.0);
  EXPECT_EQ(sut.force_n(sut.sensor), 2.0);
  EXPECT_EQ(sut.force_n(sut.rest), -3.0);
  EXPECT_EQ(ForceSums{}.force_n(1.0), 0.0);
}

TEST(ForceBudgetTest, TwelveSecondsOfKnownForcesAndMotionHaveABudget) {
  const auto has = [](std::size_t ticks, const std::function<void(BudgetSignals&)>& change) {
    BudgetSignals signals{std::vector<TickForces>(ticks, {1.0, 0.0, {}}),
                          {std::vector<double>(ticks)}};
    for (std::size_t n = 0; n < ticks; ++n)
      signals.motion[0][n] = std::sin(0.01 * static_cast<double>(n * n % 997));
    change(signals);
    return force_budget(signals).has_value();
  };
  EXPECT_TRUE(has(12'000, [](auto&) {}));
  EXPECT_FALSE(has(11'999, [](auto&) {}));
  EXPECT_FALSE(has(12'000, [](auto& signals) { signals.motion[0].pop_back(); }));
  EXPECT_FALSE(has(12'000, [](auto& signals) { signals.motion[0][11'999] = INFINITY; }));
  for (double& (*force)(TickForces&) :
       {+[](TickForces& f) -> double& { return f.feedthrough_n; },
        +[](TickForces& f) -> double& { return f.motor_n; },
        +[](TickForces& f) -> double& { return f.asked.on_time_n; },
        +[](TickForces& f) -> double& { return f.asked.unlimited_n; },
        +[](TickForces& f) -> double& { return f.asked.noiseless_n; }}) {
    EXPECT_FALSE(has(12'000, [&](auto& signals) { force(signals.forces[11'999]) = NAN; }));
  }
}

TEST(ForceBudgetTest, AnUnknownFeedthroughOrModelHasNoneAndWrongSettingsAreFoundOut) {
  StalledSession session = made({});
  AnswerConfigs others;
  others.sensing.antialias_cutoff_hz = 20.0;
  EXPECT_NE(split_trial(session.recording, session.trial, others).why.find("settings"),
            std::string::npos);
  others = {};
  others.cancellation.gain = 0.3;
  EXPECT_NE(split_trial(session.recording, session.trial, others).why.find("settings"),
            std::string::npos)
      << "the prediction is in front of the gain";
  session.recording.rig_truths[kStalledStart + 7].feedthrough_force_n(NAN);
  EXPECT_FALSE(split_trial(session.recording, session.trial, {}).budget);
  session.recording.control_models.clear();
  EXPECT_NE(split_trial(session.recording, session.trial, {}).why.find("model"), std::string::npos);
  for (auto& truth : session.recording.rig_truths) truth.feedthrough_force_n(NAN);
  EXPECT_NE(split_trial(session.recording, session.trial, others).why.find("devices"),
            std::string::npos);
}

TEST(ForceBudgetTest, WhatTheFileLostIsUnknownAndNotLate) {
  StalledSession session = made({});
  auto& samples = session.recording.raw_samples;
  samples.erase(samples.begin() + kStalledStart + 2000, samples.begin() + kStalledStart + 2500);
  session.recording.damage = {"a chunk that cannot be read"};
  const SplitTrial sut = split_trial(session.recording, session.trial, {});
  EXPECT_FALSE(sut.budget);
  EXPECT_NE(sut.why.find("0.5 s of it are lost with damaged parts"), std::string::npos) << sut.why;
  session.recording.damage.clear();
  EXPECT_EQ(split_trial(session.recording, session.trial, {}).why.find("damaged"),
            std::string::npos)
      << "of a whole file they were lost on the bus";
}

}  // namespace
}  // namespace stillhand::session::force_budget_test
