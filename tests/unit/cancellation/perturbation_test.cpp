// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/parts/perturbation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/core/cancellation/parts/countermeasure.hpp"

namespace stillhand::cancellation::perturbation_test {
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
      const Tick phase = (tick - 2000 + kPeriod) % kPeriod;
      ASSERT_NEAR(force_n, weight_at(tick) * tone().at(phase).accel_m_s2, 1e-12) << tick;
    } else if (!kPerturbedTrial.covers(tick - kRamp)) {
      ASSERT_EQ(force_n, 0.0) << tick;
    }
  }
}

}  // namespace
}  // namespace stillhand::cancellation::perturbation_test
