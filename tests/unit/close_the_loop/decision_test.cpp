// SPDX-License-Identifier: Apache-2.0
// Which model the loop over recordings keeps: METHOD Eq. CL-9.
#include "apps/close_the_loop/recorded/decision.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

namespace stillhand::close_the_loop::decision_test {
namespace {

// Blocks whose mean squares are given; the RMS follows from them.
Level level(const std::vector<double>& squares) {
  double sum = 0.0;
  for (const double square : squares) sum += square;
  return {std::sqrt(sum / static_cast<double>(squares.size())), {}, squares};
}

Remaining remaining(const Level& left) { return {level({9.0, 9.0, 9.0, 9.0}), left, {}}; }

// The prediction leaves 2 and 1; the motor what is given.
Judged judged(const Level& motor_linear, const Level& motor_augmented) {
  Judged out;
  out.seconds = 40.0;
  out.linear = remaining(level({4.0, 4.0, 4.0, 4.0}));
  out.augmented = remaining(level({1.0, 1.0, 1.0, 1.0}));
  out.motor_linear = remaining(motor_linear);
  out.motor_augmented = remaining(motor_augmented);
  return out;
}

const Level kFour = level({4.0, 4.1, 3.9, 4.0});

TEST(DecisionTest, AModelWithWhichTheMotorLeavesMoreIsNotKeptWhateverThePredictionSays) {
  const Decision sut = decide({judged(kFour, level({6.0, 6.2, 5.8, 6.1}))}, false, true, true);
  EXPECT_TRUE(sut.by_motor);
  EXPECT_FALSE(sut.kept());
  EXPECT_EQ(sut.worse.size(), 1u);
  const Decision better = decide({judged(kFour, level({2.0, 2.1, 1.9, 2.0}))}, false, true, true);
  EXPECT_TRUE(better.kept());
  EXPECT_TRUE(better.worse.empty());
}

// By construction: whatever the rows are, "kept" never stands next to a row that is worse.
TEST(DecisionTest, KeptIsNeverNextToAWorseRow) {
  std::mt19937_64 chance(7);
  std::lognormal_distribution<double> square(0.0, 1.0);
  int kept = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    // One to five blocks: with and without an interval.
    std::vector<double> linear(1 + static_cast<std::size_t>(trial % 5));
    std::vector<double> augmented(linear.size());
    for (double& each : linear) each = square(chance);
    for (double& each : augmented) each = square(chance);
    Judged one = judged(level(linear), level(augmented));
    const Decision sut = decide({one}, false, true, true);
    const double c = one.motor_linear->left.rms;
    const double c_plus = one.motor_augmented->left.rms;
    ASSERT_TRUE(!sut.kept() || c_plus < c);
    kept += sut.kept() ? 1 : 0;
  }
  EXPECT_GT(kept, 100);  // half of those that have no interval, and more
  EXPECT_LT(kept, 700);
}

// 4 of the 8 blocks fall from 4 to 1 and 4 rise from 4 to 5: mean 4 and 3.
TEST(DecisionTest, SeveralRecordsAreJudgedAsOne) {
  const Decision sut = decide({judged(level({4.0, 4.0, 4.0, 4.0}), level({1.0, 1.0, 1.0, 1.0})),
                               judged(level({4.0, 4.0, 4.0, 4.0}), level({5.0, 5.0, 5.0, 5.0}))},
                              false, true, true);
  ASSERT_TRUE(sut.step);
  EXPECT_DOUBLE_EQ(sut.step->without.rms, 2.0);
  EXPECT_DOUBLE_EQ(sut.step->left.rms, std::sqrt(3.0));
  // Differences of +3 and -1: mean 1, standard deviation 2.14, t = 1.3 of 8.
  EXPECT_FALSE(sut.kept()) << "a mean that may be chance";
  EXPECT_EQ(sut.worse.size(), 1u) << "the harm is stated";
}

TEST(DecisionTest, WhereNoMotorCanRunThePredictionDecides) {
  Judged one = judged(kFour, kFour);
  one.motor_linear.reset();
  one.motor_augmented.reset();
  const Decision other_unit = decide({one}, false, false, true);
  EXPECT_FALSE(other_unit.by_motor);
  EXPECT_TRUE(other_unit.kept());
  const Decision too_short = decide({one}, false, true, true);
  EXPECT_FALSE(too_short.by_motor);
  std::swap(one.linear, one.augmented);
  EXPECT_FALSE(decide({one}, false, false, true).kept());
}

TEST(DecisionTest, AModelThatTheCancellerDoesNotTakeIsNotKept) {
  Judged one = judged(kFour, kFour);
  one.motor_augmented.reset();
  const Decision sut = decide({one}, false, true, false);
  EXPECT_TRUE(sut.by_motor);
  EXPECT_FALSE(sut.kept()) << "although the prediction leaves less";
}

TEST(DecisionTest, NextToALinearModelThatDoesNotRunTheForceItselfIsTheYardstick) {
  Judged one = judged(kFour, level({8.0, 8.1, 7.9, 8.0}));
  one.motor_linear.reset();
  EXPECT_TRUE(decide({one}, false, true, true).kept()) << "9 without a motor";
  one.motor_augmented = remaining(level({10.0, 10.1, 9.9, 10.0}));
  EXPECT_FALSE(decide({one}, false, true, true).kept());
}

TEST(DecisionTest, WithoutAnEffectThereIsNothingToDecide) {
  EXPECT_TRUE(decide({judged(kFour, kFour)}, true, true, true).kept());
  EXPECT_FALSE(decide({judged(kFour, kFour)}, false, true, true).kept())
      << "an effect that changes nothing is not worth its model";
}

}  // namespace
}  // namespace stillhand::close_the_loop::decision_test
