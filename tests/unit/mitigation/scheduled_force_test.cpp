// SPDX-License-Identifier: Apache-2.0
// The force of an arm between two known ones: Eq. MI-5.
#include "services/core/cancellation/parts/scheduled_force.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "services/core/admittance/arm_fit.hpp"
#include "services/core/contract/config_error.hpp"
#include "tests/support/rms_share.hpp"

namespace stillhand::cancellation::scheduled_force_test {

constexpr double kTurn = 2.0 * std::numbers::pi;

admittance::ArmValues scaled_arm(double factor) {
  admittance::ArmValues arm = admittance::mean_arm();
  for (const auto k : {admittance::kArmStiffness, admittance::kGripStiffness}) arm[k] *= factor;
  for (const auto c : {admittance::kArmDamping, admittance::kGripDamping}) {
    arm[c] *= std::sqrt(factor);
  }
  return arm;
}

ScheduleConfig schedule() { return {.relaxed = scaled_arm(0.6), .holding = scaled_arm(1.2)}; }

double motion_at(int n) {
  double sum = 0.0;
  for (int k = 7; k <= 20; ++k) sum += std::sin(kTurn * 0.1 * k * 1e-3 * n + k * k);
  return 0.6 * sum;
}

struct Ran {
  double weight;
  double left;  ///< RMS of f^ - f over RMS of f, over the last 20 s
};

// An arm under the schedule for 60 s.
Ran ran(const admittance::ArmValues& truth, bool cancels, double wanted_m,
        const ScheduleConfig& config = schedule()) {
  ScheduledForce sut(config);
  LinearArm arm(truth, {});
  double motor_n = 0.0;
  support::RmsShare left;
  ArmPrediction now{};
  for (int n = 0; n < 60'000; ++n) {
    const double a = motion_at(n);
    // The sample of this tick comes before the force that answers it.
    LinearArm at_sample = arm;
    now = at_sample.step(a, 0.0);
    const double x = now.displacement_m + wanted_m * std::sin(kTurn * 0.31 * 1e-3 * n);
    const double predicted_n = sut.step(a, x / 0.10, motor_n);
    motor_n = cancels ? -predicted_n : 0.0;
    arm.step(a, motor_n);
    if (n >= 40'000) left.add(predicted_n - now.held_n, now.held_n);
  }
  return {sut.weight(), left.value()};
}

TEST(ScheduledForceTest, FindsEitherArm) {
  EXPECT_NEAR(ran(scaled_arm(0.6), false, 0.0).weight, 0.0, 0.02);
  EXPECT_NEAR(ran(scaled_arm(1.2), false, 0.0).weight, 1.0, 0.02);
}

// In between the response is no mixture of the two, so something is left; of either end alone more
// than twice as much is.
TEST(ScheduledForceTest, LeavesLittleOfAnArmInBetween) {
  const Ran sut = ran(scaled_arm(0.85), false, 0.0);
  EXPECT_GT(sut.weight, 0.2);
  EXPECT_LT(sut.weight, 0.8);
  for (const double end : {0.6, 1.2}) {
    const ScheduleConfig alone{.relaxed = scaled_arm(end), .holding = scaled_arm(end)};
    EXPECT_LT(2.0 * sut.left, ran(scaled_arm(0.85), false, 0.0, alone).left) << end;
  }
}

// Cancelling takes away the motion from which it learns, but not the reason why it would be wrong.
TEST(ScheduledForceTest, FindsTheArmWhileItCancels) {
  EXPECT_LT(ran(scaled_arm(0.6), true, 0.0).left, 0.08);
  EXPECT_LT(ran(scaled_arm(1.2), true, 0.0).left, 0.08);
}

// Motion that the person wants, as large as the shaken one, below the band.
TEST(ScheduledForceTest, IsNotLedByWhatThePersonWants) {
  EXPECT_NEAR(ran(scaled_arm(1.2), false, 0.006).weight, 1.0, 0.1);
  EXPECT_NEAR(ran(scaled_arm(0.6), false, 0.006).weight, 0.0, 0.1);
}

TEST(ScheduledForceTest, KeepsItsWeightOfTwoEqualArms) {
  ScheduleConfig config = schedule();
  config.holding = config.relaxed;
  ScheduledForce sut(config);
  for (int n = 0; n < 60'000; ++n) sut.step(motion_at(n), 0.0, 0.0);
  EXPECT_EQ(sut.weight(), 0.5);
}

TEST(ScheduledForceTest, RefusesSettingsOutOfRange) {
  ScheduleConfig config = schedule();
  config.memory_s = 0.0;
  EXPECT_THROW(ScheduledForce{config}, ConfigError);
  config = schedule();
  config.lever_m = 0.0;
  EXPECT_THROW(ScheduledForce{config}, ConfigError);
}

}  // namespace stillhand::cancellation::scheduled_force_test
