// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/parts/motor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

namespace stillhand::rig::motor_test {
namespace {

constexpr double kLever_m = 0.1;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

Motor running(double force_n) {
  Motor motor(MotorConfig{}, kLever_m);
  for (int n = 0; n < 200; ++n) motor.step({true, 1, force_n, true});
  return motor;
}

struct Loss {
  const char* name;
  MotorDemand demand;
  Flag flag;
};

class MotorLossTest : public testing::TestWithParam<Loss> {};

// The safety promise of the rig: whatever is lost, 50 ms later there is no force.
TEST_P(MotorLossTest, ForceIsExactlyZeroFiftyMillisecondsAfter) {
  auto sut = running(20.0);
  double before_n = sut.step({true, 1, 20.0, true}).force_n;
  ASSERT_NEAR(before_n, 20.0, 1e-6);
  Flags seen = kGood;
  for (int n = 0; n < 50; ++n) {
    const auto out = sut.step(GetParam().demand);
    seen |= out.flags;
    ASSERT_LE(out.force_n, before_n);
    ASSERT_GE(out.force_n, 0.0);
    before_n = out.force_n;
  }
  EXPECT_EQ(before_n, 0.0);
  EXPECT_TRUE(seen & kRampingDown);
  EXPECT_EQ(seen & GetParam().flag, GetParam().flag);
  for (int n = 0; n < 100; ++n) ASSERT_EQ(sut.step(GetParam().demand).force_n, 0.0);
}

std::string cause(const testing::TestParamInfo<Loss>& loss) { return loss.param.name; }

INSTANTIATE_TEST_SUITE_P(
    EveryCause, MotorLossTest,
    testing::Values(
        Loss{"interlock", {true, 1, 20.0, false}, kInhibited},
        Loss{"absent", {false, 1, 20.0, true}, kGood},
        Loss{"nan", {true, 1, kNaN, true}, kInputInvalid},
        Loss{"infinite", {true, 1, kInf, true}, kInputInvalid},
        Loss{"old", {true, 11, 20.0, true}, kInputStale},
        Loss{"oldest", {true, std::numeric_limits<Tick>::max(), 20.0, true}, kInputStale},
        Loss{"from_the_future", {true, -1, 20.0, true}, kInputStale}),
    cause);

TEST(MotorTest, ACommandAtTheAgeLimitStillActs) {
  auto sut = running(5.0);
  EXPECT_NEAR(sut.step({true, MotorConfig{}.max_motor_age_ticks, 5.0, true}).force_n, 5.0, 1e-6);
}

TEST(MotorTest, NoCommandRaisesTheForceAboveTheLimits) {
  const MotorConfig config;
  Motor sut(config, kLever_m);
  Flags seen = kGood;
  for (int n = 0; n < 1000; ++n) {
    const auto out = sut.step({true, 0, n % 2 == 0 ? 1e300 : 1e3, true});
    seen |= out.flags;
    ASSERT_LE(std::abs(out.force_n), config.limits.max_force_n);
  }
  EXPECT_TRUE(seen & kSaturated);
}

// First-order lag: a step of 1 N (below the slew limit) reaches 1 - e^-1 after lag_s.
TEST(MotorTest, FollowsAStepWithItsLag) {
  MotorConfig config;
  config.lag_s = 0.002;
  Motor sut(config, kLever_m);
  sut.step({true, 0, 1.0, true});
  EXPECT_NEAR(sut.step({true, 0, 1.0, true}).force_n, 1.0 - std::exp(-1.0), 1e-12);
}

// kt * ratio / lever = 0.0302 * 10 / 0.1 = 3.02 N/A.
TEST(MotorTest, CurrentLimitBoundsTheForce) {
  MotorConfig config;
  config.current_limit_a = 2.0;
  Motor sut(config, kLever_m);
  double force_n = 0.0;
  for (int n = 0; n < 500; ++n) force_n = sut.step({true, 0, 20.0, true}).force_n;
  EXPECT_NEAR(force_n, 6.04, 1e-9);
}

TEST(MotorTest, ASingleLostCommandCostsOneRampStepOnly) {
  auto sut = running(20.0);
  sut.step({true, 1, kNaN, true});
  const double after_n = sut.step({true, 1, 20.0, true}).force_n;
  EXPECT_GE(after_n, 20.0 * (1.0 - 1.0 / 40.0));
}

// Eq. RG-8.  After ten lags of 1.5 ms the rest is exp(-10).
TEST(MotorTest, DelayAndGainActBeforeTheLag) {
  MotorConfig config;
  config.delay_s = 0.03;
  config.gain = 0.5;
  Motor sut(config, kLever_m);
  for (int n = 0; n < 30; ++n) ASSERT_EQ(sut.step({true, 1, 8.0, true}).force_n, 0.0) << n;
  for (int n = 0; n < 15; ++n) sut.step({true, 1, 8.0, true});
  EXPECT_NEAR(sut.step({true, 1, 8.0, true}).force_n, 4.0, 4.0 * std::exp(-10.0));
}

// A force from before a gap never acts after it.
TEST(MotorTest, AGapClearsTheDelay) {
  MotorConfig config;
  config.delay_s = 0.2;
  Motor sut(config, kLever_m);
  for (int n = 0; n < 400; ++n) sut.step({true, 1, 20.0, true});
  for (int n = 0; n < 60; ++n) sut.step({true, 1, 20.0, false});
  for (int n = 0; n < 300; ++n) ASSERT_EQ(sut.step({true, 1, 0.0, true}).force_n, 0.0) << n;
}

}  // namespace
}  // namespace stillhand::rig::motor_test
