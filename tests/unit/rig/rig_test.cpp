// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/rig.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/support/refusal.hpp"

namespace stillhand::rig::rig_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// A tracking trial's input: 1 Hz motion, a person, a motor.
RigInput tracking(int n) {
  const double w = 2.0 * std::numbers::pi;
  const double phase_rad = w * n * kControlPeriod_s;
  RigInput input;
  input.command_valid = true;
  input.command_position_m = 0.05 * std::sin(phase_rad);
  input.command_velocity_m_s = 0.05 * w * std::cos(phase_rad);
  input.command_acceleration_m_s2 = -0.05 * w * w * std::sin(phase_rad);
  input.motor_valid = true;
  input.motor_age_ticks = 1;
  input.motor_force_n = 3.0 * std::sin(0.7 * phase_rad);
  input.operator_valid = true;
  input.operator_age_ticks = 2;
  input.operator_force_n = 15.0 * std::sin(0.3 * phase_rad);
  input.motor_permitted = true;
  return input;
}

void expect_same(const RigOutput& a, const RigOutput& b) {
  ASSERT_EQ(a.raw.accel_x_v, b.raw.accel_x_v);
  ASSERT_EQ(a.raw.accel_y_v, b.raw.accel_y_v);
  ASSERT_EQ(a.raw.accel_z_v, b.raw.accel_z_v);
  ASSERT_EQ(a.raw.load_cell_v, b.raw.load_cell_v);
  ASSERT_EQ(a.raw.encoder_counts, b.raw.encoder_counts);
  ASSERT_EQ(a.truth.theta_rad, b.truth.theta_rad);
  ASSERT_EQ(a.truth.hand_force_n, b.truth.hand_force_n);
  ASSERT_EQ(a.truth.feedthrough_force_n, b.truth.feedthrough_force_n);
  ASSERT_EQ(a.all_flags(), b.all_flags());
}

// A command that answers n drives the stick from sample n to sample n + 1 in both orders: after the
// sample of tick n, or before that of tick n + 1, where it is one tick old (Eq. RG-38).
TEST(RigTest, TheAnswerToASampleMovesTheStickAlikeInBothOrders) {
  Rig before{RigConfig{}};
  Rig after{RigConfig{}};
  double answer_n = 0.0;
  for (int n = 0; n < 5000; ++n) {
    auto input = tracking(n);
    input.motor_force_n = answer_n;
    const RigOutput late = before.step(input);

    RigOutput soon = after.sample(tracking(n));
    ASSERT_EQ(late.truth.motor_force_n, soon.truth.motor_force_n) << "n = " << n;
    if (n > 0) expect_same(late, soon);
    answer_n = -2.0 * soon.raw.accel_y_v;
    input.motor_age_ticks = 0;
    input.motor_force_n = answer_n;
    after.drive(input, soon);
  }
}

// The sample is older than the force that answers it; the truth of the tick states the force.
TEST(RigTest, AForceDoesNotReachTheSampleThatItAnswers) {
  Rig pushed{RigConfig{}};
  Rig still{RigConfig{}};
  auto input = tracking(0);
  input.motor_force_n = 20.0;
  RigOutput first = pushed.sample(input);
  RigOutput other = still.sample(input);
  pushed.drive(input, first);
  input.motor_force_n = 0.0;
  still.drive(input, other);
  EXPECT_EQ(first.truth.hand_force_n, other.truth.hand_force_n);
  EXPECT_GT(first.truth.motor_force_n, 0.0);
  EXPECT_NE(pushed.sample(tracking(1)).truth.hand_force_n,
            still.sample(tracking(1)).truth.hand_force_n);
}

// Without permission a tick's force falls, whatever the order, and the flags of the tick say why.
TEST(RigTest, TheMotorsFlagsAreThoseOfTheForceThatIsStated) {
  Rig sut{RigConfig{}};
  auto input = tracking(0);
  RigOutput output = sut.sample(input);
  input.motor_permitted = false;
  sut.drive(input, output);
  EXPECT_NE(output.all_flags() & kInhibited, 0u);
  output = sut.sample(tracking(1));
  EXPECT_NE(output.all_flags() & kInhibited, 0u) << "the force that acted until this sample";
  sut.drive(tracking(1), output);
  EXPECT_EQ(output.all_flags() & kInhibited, 0u);
}

// The command starts with a jump of speed, which saturates the platform; it has caught up, 1 s
// later.
TEST(RigTest, AGoodTrialRaisesNoFlag) {
  Rig sut{RigConfig{}};
  for (int n = 0; n < 1000; ++n) sut.step(tracking(n));
  for (int n = 1000; n < 6000; ++n) ASSERT_EQ(sut.step(tracking(n)).all_flags(), kGood) << n;
}

// With the motor off, platform at rest and a hand without nerves nothing moves and the load cell
// reads zero.
TEST(RigTest, AtRestEverythingIsZero) {
  RigConfig config;
  config.body.neuromuscular = {};
  Rig sut{config};
  const RigInput input{.command_valid = true};
  for (int n = 0; n < 1000; ++n) {
    const auto truth = sut.step(input).truth;
    ASSERT_EQ(truth.platform_position_m, 0.0);
    ASSERT_EQ(truth.theta_rad, 0.0);
    ASSERT_EQ(truth.hand_force_n, 0.0);
    ASSERT_EQ(truth.feedthrough_force_n, 0.0);
  }
}

// A force opposite to the true feedthrough leaves the stick where it is: what is left comes from
// the motor's lag of 1.5 ms and one tick of delay, 2.5 ms * 2 pi * 1 Hz = 1.6 % of the motion; the
// friction of 0.2 N hides part of it.  Twice that is allowed.
TEST(RigTest, AnExactCancellationForceKeepsTheStickStill) {
  const auto peak_theta_rad = [](double share) {
    Rig sut{RigConfig{}};
    double peak_rad = 0.0;
    double feedthrough_n = 0.0;
    for (int n = 0; n < 6000; ++n) {
      auto input = tracking(n);
      input.operator_valid = false;
      input.motor_force_n = -share * feedthrough_n;
      const auto out = sut.step(input);
      feedthrough_n = out.truth.feedthrough_force_n;
      if (n > 2000) peak_rad = std::max(peak_rad, std::abs(out.truth.theta_rad));
    }
    return peak_rad;
  };
  const double without_rad = peak_theta_rad(0.0);
  EXPECT_GT(without_rad, 0.03);
  EXPECT_LT(peak_theta_rad(1.0), 0.032 * without_rad);
}

TEST(RigTest, AStaleOperatorForceFadesToZero) {
  Rig sut{RigConfig{}};
  RigInput input = tracking(0);
  input.operator_force_n = 15.0;
  for (int n = 0; n < 500; ++n) sut.step(input);
  input.operator_age_ticks = 100;
  EXPECT_EQ(sut.step(input).truth.volitional_force_n, 15.0);
  input.operator_age_ticks = 0;
  EXPECT_EQ(sut.step(input).flags & kInputStale, kGood);
  double before_n = 15.0;
  for (int n = 0; n < 50; ++n) {
    input.operator_age_ticks = n % 2 == 0 ? 101 : -1;  // too old, and from the future
    const auto out = sut.step(input);
    EXPECT_TRUE(out.flags & kInputStale);
    ASSERT_LT(out.truth.volitional_force_n, before_n);
    before_n = out.truth.volitional_force_n;
  }
  EXPECT_EQ(before_n, 0.0);
}

TEST(RigTest, AnOperatorForceIsBounded) {
  Rig sut{RigConfig{}};
  RigInput input = tracking(0);
  input.operator_force_n = -1e9;
  RigOutput out{};
  for (int n = 0; n < 100; ++n) out = sut.step(input);
  EXPECT_EQ(out.truth.volitional_force_n, -60.0);
  EXPECT_TRUE(out.flags & kSaturated);
}

/// Sum over |impulse response| of the feedthrough: its largest value per unit of acceleration.
double feedthrough_peak_gain(bool pegged) {
  const RigConfig config;
  Body body(config.body, config.stick);
  double sum = 0.0;
  for (int n = 0; n < 5000; ++n) {
    sum += std::abs(body.step({n == 0 ? 1.0 : 0.0, 0.0, 0.0, pegged}).feedthrough_force_n);
  }
  return sum;
}

double hostile(std::mt19937_64& random) {
  constexpr std::array<double, 10> kEvil = {kNaN,   kInf, -kInf, 1e308, -1e308,
                                            5e-324, 0.0,  1.0,   -60.0, 1e3};
  const auto pick = random() % 16;
  if (pick < kEvil.size()) return kEvil[pick];
  return std::uniform_real_distribution<double>(-2.0, 2.0)(random);
}

void expect_finite_and_bounded(const RigOutput& out, const RigConfig& config,
                               double force_bound_n) {
  const double steel_rad =
      config.stick.stop_angle_rad + config.stick.stop_travel_m / config.stick.lever_m;
  ASSERT_LE(std::abs(out.truth.platform_position_m), config.platform.workspace_m);
  ASSERT_LE(std::abs(out.truth.platform_acceleration_m_s2),
            config.platform.max_acceleration_m_s2 + 1e-9);
  ASSERT_LE(std::abs(out.truth.theta_rad), steel_rad * (1.0 + 1e-12));
  ASSERT_LE(std::abs(out.truth.feedthrough_force_n), force_bound_n);
  ASSERT_LE(std::abs(out.truth.motor_force_n), config.motor.limits.max_force_n);
  ASSERT_LE(std::abs(out.truth.volitional_force_n), config.max_operator_force_n);
  ASSERT_TRUE(std::isfinite(out.truth.hand_force_n));
  ASSERT_TRUE(std::isfinite(out.truth.omega_rad_s));
  for (const double volts :
       {out.raw.accel_x_v, out.raw.accel_y_v, out.raw.accel_z_v, out.raw.load_cell_v}) {
    ASSERT_LE(std::abs(volts), config.sensors.adc_range_v);
  }
  ASSERT_LE(std::abs(out.raw.encoder_counts), 400);  // 0.544 rad * 4096 / 2 pi = 355
}

// A million ticks of anything: no NaN, no infinity, nothing beyond its limit.
TEST(RigTest, SurvivesAnyInput) {
  const RigConfig config;
  Rig sut(config);
  // Changing muscles mixes the two responses: the sum of their peak gains bounds what either does.
  const double bound_n = config.platform.max_acceleration_m_s2 *
                         (feedthrough_peak_gain(true) + feedthrough_peak_gain(false));
  std::mt19937_64 random(2024);
  RigInput input;
  for (int n = 0; n < 1000000; ++n) {
    const auto bits = random();
    input.command_valid = (bits & 7) != 0;
    input.motor_valid = (bits & 8) != 0;
    input.operator_valid = (bits & 16) != 0;
    input.motor_permitted = (bits & 96) != 0;
    if ((bits >> 8) % 200 == 0) input.pegged = !input.pegged;
    input.command_position_m = hostile(random);
    input.command_velocity_m_s = hostile(random);
    input.command_acceleration_m_s2 = hostile(random);
    input.motor_force_n = hostile(random);
    input.operator_force_n = hostile(random);
    input.motor_age_ticks = static_cast<Tick>(bits >> 40) % 16 - 2;
    input.operator_age_ticks =
        (bits >> 20) % 64 == 0 ? std::numeric_limits<Tick>::min() : static_cast<Tick>(bits % 120);
    expect_finite_and_bounded(sut.step(input), config, bound_n);
    if (HasFatalFailure()) FAIL() << "tick " << n;
  }
}

// A peg that goes in and out at any rhythm must not pump the body up through its muscles.
TEST(RigTest, AFlutteringPegDoesNotPumpTheBody) {
  const RigConfig config;
  const double bound_n = config.platform.max_acceleration_m_s2 *
                         (feedthrough_peak_gain(true) + feedthrough_peak_gain(false));
  for (int half_period_ticks = 1; half_period_ticks < 200; half_period_ticks += 3) {
    Rig sut(config);
    for (int n = 0; n < 5000; ++n) {
      auto input = tracking(n);
      input.pegged = (n / half_period_ticks) % 2 == 0;
      expect_finite_and_bounded(sut.step(input), config, bound_n);
      if (HasFatalFailure()) FAIL() << "half period " << half_period_ticks << ", tick " << n;
    }
  }
}

TEST(RigTest, NamesTheFieldThatIsOutOfRange) {
  RigConfig config;
  config.body.grip_stiffness_n_m = kNaN;
  EXPECT_THAT(support::refusal([&] { Rig sut(config); }),
              testing::HasSubstr("rig.body.grip_stiffness_n_m"));
}

}  // namespace
}  // namespace stillhand::rig::rig_test
