// SPDX-License-Identifier: Apache-2.0
// What nerves and muscles add to the body: Eq. RG-27 to RG-32, RG-40.
#include "services/core/rig/parts/neuromuscular.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

#include "services/core/contract/tick.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/rig/rig.hpp"
#include "services/core/signal/moments.hpp"

namespace stillhand::rig::neuromuscular_test {
namespace {

using signal::rms;

constexpr int kSecond = 1000;

// 2 m/s^2 RMS at 1 Hz.
double shaking_m_s2(int n) {
  return 2.0 * std::sqrt(2.0) * std::sin(kTwoPi * n * kControlPeriod_s);
}

TEST(NeuromuscularTest, AddsNothingByDefault) {
  Neuromuscular sut(NeuromuscularConfig{}, 1);
  for (int n = 0; n < 5 * kSecond; ++n) {
    const auto out = sut.step({shaking_m_s2(n), 10.0, false});
    ASSERT_EQ(out.stiffness_level, 0);
    ASSERT_EQ(out.hand_n, 0.0);
    ASSERT_EQ(out.resisting_n, 0.0);
  }
}

// Eq. RG-27: after ten memories of 4 s the felt RMS is 2 m/s^2 to within the ripple of the mean
// square, 1/(4 pi f T) = 2 %; ln(1 + 0.25 * 2) = 0.405, in steps of 0.02, to within a step.
TEST(NeuromuscularTest, VibrationStiffensTheTrackingArmAndNotTheIdleOne) {
  const NeuromuscularConfig config{.stiffening_by_vibration_s2_m = 0.25};
  for (const bool pegged : {false, true}) {
    Neuromuscular sut(config, 1);
    int level = 0;
    for (int n = 0; n < 40 * kSecond; ++n) {
      level = sut.step({shaking_m_s2(n), 0.0, pegged}).stiffness_level;
    }
    EXPECT_NEAR(level * StiffnessLevels::kStep, pegged ? 0.0 : std::log(1.5), 0.02) << pegged;
  }
}

TEST(NeuromuscularTest, SofteningEndsAtItsBound) {
  const NeuromuscularConfig config{.stiffening_by_vibration_s2_m = -0.3};
  Neuromuscular sut(config, 1);
  int level = 0;
  for (int n = 0; n < 40 * kSecond; ++n) {
    level = sut.step({10.0 * shaking_m_s2(n), 0.0, false}).stiffness_level;
  }
  EXPECT_EQ(level, StiffnessLevels::kLowest);
}

// Eq. RG-40, in steps of 0.02 of the logarithm, a tenth of a second apart.
TEST(NeuromuscularTest, TheStiffnessChangesOnceAndForGood) {
  const NeuromuscularConfig config{.change = 0.6, .change_at_s = 2.0};
  for (const bool pegged : {false, true}) {
    Neuromuscular sut(config, 1);
    for (int n = 0; n < 10 * kSecond; ++n) {
      const int level = sut.step({0.0, 0.0, pegged}).stiffness_level;
      if (n >= 2 * kSecond - 1 && n <= 2 * kSecond + 100) continue;
      ASSERT_NEAR(level * StiffnessLevels::kStep, n < 2 * kSecond ? 0.0 : std::log(1.6), 0.01) << n;
    }
  }
}

// Eq. RG-28.  5,000 s hold 5000 / (2 * 5) = 500 independent values: the deviation is known to
// 1 / sqrt(2 * 500) = 3 %; four times that.
TEST(NeuromuscularTest, WanderHasItsDeviationAndItsTimeConstant) {
  const NeuromuscularConfig config{.wander = 0.2, .wander_time_s = 5.0};
  Neuromuscular sut(config, 3);
  std::vector<double> log_stiffness;
  for (int n = 0; n < 5000 * kSecond; ++n) {
    const auto out = sut.step({0.0, 0.0, false});
    if (n % 100 == 0) log_stiffness.push_back(out.stiffness_level * StiffnessLevels::kStep);
  }
  EXPECT_NEAR(rms(log_stiffness), 0.2, 0.2 * 0.13);
  double together = 0.0;
  constexpr std::size_t kTimeConstant = 50;  // samples of 0.1 s
  for (std::size_t i = kTimeConstant; i < log_stiffness.size(); ++i) {
    together += log_stiffness[i] * log_stiffness[i - kTimeConstant];
  }
  together /= static_cast<double>(log_stiffness.size() - kTimeConstant);
  EXPECT_NEAR(together / std::pow(rms(log_stiffness), 2), std::exp(-1.0), 0.12);
}

// 200 s of noise of 0.1 to 5 Hz, of 7 to 12 Hz: 2 * 5 * 200 = 2000 degrees of freedom and as many,
// 1.6 % of RMS; four times that.
TEST(NeuromuscularTest, InvoluntaryForcesHaveTheirSize) {
  for (const bool tremor : {false, true}) {
    NeuromuscularConfig config;
    (tremor ? config.tremor_force_n : config.involuntary_force_n) = 0.5;
    Neuromuscular sut(config, 5);
    std::vector<double> force_n;
    for (int n = 0; n < 200 * kSecond; ++n) force_n.push_back(sut.step({0.0, 0.0, true}).hand_n);
    EXPECT_NEAR(rms(force_n), 0.5, 0.5 * 0.065) << tremor;
  }
}

TEST(NeuromuscularTest, UnmeasuredMotionPushesTheHandOnlyWhileThePlatformMoves) {
  const NeuromuscularConfig config{.unmeasured_force_n_s2_m = 1.5};
  Neuromuscular sut(config, 5);
  for (int n = 0; n < 10 * kSecond; ++n) ASSERT_EQ(sut.step({0.0, 0.0, false}).hand_n, 0.0);
  std::vector<double> force_n;
  for (int n = 0; n < 220 * kSecond; ++n) {
    const double now_n = sut.step({shaking_m_s2(n), 0.0, false}).hand_n;
    if (n >= 20 * kSecond) force_n.push_back(now_n);
  }
  // 1.3 Hz for 200 s: 520 degrees of freedom, 3.1 % of RMS; four times that.
  EXPECT_NEAR(rms(force_n), 3.0, 3.0 * 0.13);
}

TEST(NeuromuscularTest, TheHandOpposesAShareOfTheMotorAfterItsDelay) {
  const NeuromuscularConfig config{.motor_resistance = 0.3, .motor_resistance_delay_s = 0.05};
  Neuromuscular sut(config, 1);
  for (int n = 0; n < 200; ++n) {
    const double resisting_n = sut.step({0.0, 4.0, false}).resisting_n;
    ASSERT_NEAR(resisting_n, n < 50 ? 0.0 : -1.2, 1e-12) << n;
  }
  EXPECT_EQ(sut.step({0.0, 4.0, true}).resisting_n, 0.0);
}

// Eq. RG-29 at 1 Hz: (k + j w c) exp(-j w d) H, H the muscle's second-order lag.  The sampled lag
// answers an input held over the tick, half a tick late: pi f dt = 0.3 %, and a tick until the
// state shows.
TEST(ReflexTest, AnswersAStretchAsItsTransferFunctionSays) {
  const NeuromuscularConfig config{.reflex_stiffness_n_m = 300.0, .reflex_damping_n_s_m = 30.0};
  Reflex sut(config, kControlPeriod_s);
  ASSERT_TRUE(sut.acts());
  const double w = kTwoPi;
  std::complex<double> sum;
  for (int n = 0; n < 12 * kSecond; ++n) {
    const double t_s = n * kControlPeriod_s;
    const double force_n = sut.step(0.01 * std::sin(w * t_s), 0.01 * w * std::cos(w * t_s), false);
    if (n >= 2 * kSecond) sum += force_n * std::polar(1.0, -w * t_s) * (2.0 / (10.0 * kSecond));
  }
  const std::complex<double> j(0.0, 1.0);
  const double w0 = kTwoPi * config.reflex_muscle_hz;
  const std::complex<double> muscle =
      w0 * w0 / (w0 * w0 - w * w + 2.0 * j * config.reflex_muscle_damping * w * w0);
  const std::complex<double> expected =
      0.01 * (300.0 + j * w * 30.0) * std::exp(-j * w * config.reflex_delay_s) * muscle / j;
  EXPECT_LT(std::abs(sum - expected), 0.01 * std::abs(expected));
}

TEST(ReflexTest, ItsForceIsBounded) {
  const NeuromuscularConfig config{.reflex_stiffness_n_m = 1000.0};
  Reflex sut(config, kControlPeriod_s);
  double most_n = 0.0;
  for (int n = 0; n < 3 * kSecond; ++n) most_n = std::max(most_n, sut.step(1.0, 0.0, false));
  EXPECT_EQ(most_n, config.reflex_max_force_n);
}

// A hand that opposes half of the motor moves the stick as half the motor would, after the delay.
TEST(NeuromuscularTest, InTheRigResistanceTakesItsShareOfTheMotorAway) {
  RigConfig config;
  config.stick.coulomb_friction_n = 0.0;
  config.body.neuromuscular.motor_resistance = 0.5;
  RigConfig half_motor;
  half_motor.stick.coulomb_friction_n = 0.0;
  half_motor.motor.gain = 0.5;
  Rig sut(config);
  Rig expected(half_motor);
  RigInput input{.command_valid = true, .motor_valid = true};
  input.motor_permitted = true;
  input.motor_force_n = 10.0;
  double theta_rad = 0.0;
  double expected_rad = 0.0;
  for (int n = 0; n < 10 * kSecond; ++n) {
    theta_rad = sut.step(input).truth.theta_rad;
    expected_rad = expected.step(input).truth.theta_rad;
  }
  ASSERT_GT(expected_rad, 0.01);
  EXPECT_NEAR(theta_rad, expected_rad, 1e-6 * expected_rad);
}

// The largest of everything at once: the stick stays between its stops, and every output finite.
TEST(NeuromuscularTest, AHandWithEveryEffectAtItsEndKeepsTheRigBounded) {
  RigConfig config;
  auto& hand = config.body.neuromuscular;
  hand = {.stiffening_by_vibration_s2_m = 2.0,
          .stiffening_by_motor_n = 1.0,
          .wander = 0.5,
          .wander_time_s = 1.0,
          .reflex_stiffness_n_m = 1000.0,
          .reflex_damping_n_s_m = 100.0,
          .reflex_delay_s = 0.15,
          .reflex_max_force_n = 60.0,
          .motor_resistance = 1.0,
          .motor_resistance_delay_s = 0.5,
          .involuntary_force_n = 5.0,
          .tremor_force_n = 2.0,
          .unmeasured_force_n_s2_m = 5.0};
  config.motor.delay_s = 0.2;
  config.motor.gain = 2.0;
  Rig sut(config);
  const double most_rad = config.stick.stop_angle_rad + config.stick.stop_travel_m / 0.1 + 1e-9;
  RigInput input{.command_valid = true, .motor_valid = true, .operator_valid = true};
  input.motor_permitted = true;
  for (int n = 0; n < 60 * kSecond; ++n) {
    input.command_position_m = 0.1 * std::sin(kTwoPi * 0.7 * n * kControlPeriod_s);
    input.motor_force_n = n % 1500 < 700 ? 25.0 : -25.0;
    const RigOutput out = sut.step(input);
    ASSERT_LE(std::abs(out.truth.theta_rad), most_rad) << n;
    ASSERT_LE(std::abs(out.truth.motor_force_n), config.motor.limits.max_force_n) << n;
    ASSERT_TRUE(std::isfinite(out.truth.feedthrough_force_n)) << n;
    ASSERT_TRUE(std::isfinite(out.raw.load_cell_v)) << n;
  }
}

TEST(NeuromuscularTest, TheSameSeedGivesTheSameBits) {
  const NeuromuscularConfig config{.wander = 0.3, .involuntary_force_n = 1.0};
  Neuromuscular sut(config, 9);
  Neuromuscular same(config, 9);
  Neuromuscular other(config, 10);
  bool differs = false;
  for (int n = 0; n < 10 * kSecond; ++n) {
    const auto out = sut.step({});
    const auto again = same.step({});
    ASSERT_EQ(out.hand_n, again.hand_n);
    ASSERT_EQ(out.stiffness_level, again.stiffness_level);
    differs = differs || out.hand_n != other.step({}).hand_n;
  }
  EXPECT_TRUE(differs);
}

}  // namespace
}  // namespace stillhand::rig::neuromuscular_test
