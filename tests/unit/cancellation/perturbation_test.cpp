// SPDX-License-Identifier: Apache-2.0
#include "services/cancellation/parts/perturbation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "services/cancellation/parts/countermeasure.hpp"
#include "services/signal/random.hpp"

namespace stillhand::cancellation {
namespace {

constexpr Tick kPeriod = 1000;
constexpr double kForce_n = 6.0;
constexpr Tick kRamp = 40;  // of the envelope
constexpr Trial kPerturbedTrial{.number = 1,
                                .phase = TrialPhase::kTracking,
                                .start_tick = 2000,
                                .duration_ticks = 5000,
                                .ramp_ticks = 500};

signal::Multisine tone() { return {kPeriod, 1000.0, {{3, kForce_n, 0.7}}}; }

CountermeasureInput good(Tick tick) {
  CountermeasureInput input{};
  input.tick = tick;
  input.enabled = input.permitted = true;
  input.trial = kPerturbedTrial;
  return input;
}

// w(tick) of Eq. CC-17 before the first measured tick and after the last.
double weight_at(Tick tick) {
  const Trial& trial = kPerturbedTrial;
  const Tick end = trial.start_tick + trial.duration_ticks;
  const Tick outside = tick < trial.start_tick ? trial.start_tick - tick : tick - end + 1;
  return 1.0 - static_cast<double>(outside) / static_cast<double>(trial.ramp_ticks);
}

// Eq. CC-17: 6 N at 3 Hz needs 113 N/s, far below the limits.
TEST(PerturbationTest, IsTheMultisineOverTheMeasuredTicksAndZeroOutsideTheTrial) {
  Countermeasure sut({}, {.perturbation = tone()});
  for (Tick tick = 0; tick < 9000; ++tick) {
    const double force_n = sut.step(good(tick)).force_n;
    if (kPerturbedTrial.measures(tick)) {
      ASSERT_DOUBLE_EQ(force_n, tone().at(tick - 2000).accel_m_s2) << tick;
    } else if (kPerturbedTrial.covers(tick)) {
      ASSERT_LE(std::abs(force_n), kForce_n * weight_at(tick) + 1e-12) << tick;
    } else if (!kPerturbedTrial.covers(tick - kRamp)) {
      ASSERT_EQ(force_n, 0.0) << tick;
    }
  }
}

TEST(PerturbationTest, FallsToZeroWithinTheRampOnceItMayNotAct) {
  const Config config;
  const auto spoil = [&](int how, CountermeasureInput& input) {
    if (how == 0) input.permitted = false;
    if (how == 1) input.enabled = false;
    if (how == 2) input.sensed_flags = kFault;
    if (how == 3) input.sensed[0] = std::numeric_limits<double>::quiet_NaN();
    if (how == 4) input.tick = 3000;  // a stuck sender
  };
  for (int how = 0; how < 5; ++how) {
    Countermeasure sut(config, {.perturbation = tone()});
    for (Tick tick = 1500; tick <= 3000; ++tick) sut.step(good(tick));
    double force_n = 1.0;
    for (Tick tick = 3001; tick <= 3001 + config.limits.ramp_ticks; ++tick) {
      CountermeasureInput input = good(tick);
      spoil(how, input);
      force_n = sut.step(input).force_n;
    }
    EXPECT_EQ(force_n, 0.0) << how;
  }
}

// Whatever comes: the bound and the change a tick are those of the settings.
TEST(PerturbationTest, IsBoundedForAnyInput) {
  Config config;
  config.limits.max_force_n = 4.0;  // below what the multisine asks for
  Countermeasure sut(config, {.perturbation = tone()});
  signal::Gaussian draw(1, 2);
  double before_n = 0.0;
  Tick tick = 0;
  for (int i = 0; i < 100'000; ++i) {
    const double chance = draw.uniform();
    tick += chance < 0.02 ? -50 : chance < 0.04 ? 90 : 1;
    if (tick > 9000) tick = 0;
    CountermeasureInput input = good(tick);
    input.enabled = draw.uniform() > 0.01;
    input.permitted = draw.uniform() > 0.01;
    if (draw.uniform() < 0.01) input.sensed[1] = 1e308;
    const double force_n = sut.step(input).force_n;
    ASSERT_LE(std::abs(force_n), 4.0);
    // The envelope's slew, and its ramp to zero of at most 4 N in 40 ticks.
    ASSERT_LE(std::abs(force_n - before_n), 2.0 + 1e-12);
    before_n = force_n;
  }
}

}  // namespace
}  // namespace stillhand::cancellation
