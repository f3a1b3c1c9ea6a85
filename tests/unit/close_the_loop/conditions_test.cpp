// SPDX-License-Identifier: Apache-2.0
// Means, paired differences and shares over the repeats, from numbers that are made up.
#include "apps/close_the_loop/session/conditions.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace stillhand::close_the_loop::conditions_test {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::vector<TrialRun> runs(const char* label, const std::vector<double>& errors_mm) {
  std::vector<TrialRun> out;
  for (const double error_mm : errors_mm) {
    TrialRun run;
    run.label = label;
    run.metrics.rms_error_mm = error_mm;
    out.push_back(run);
  }
  return out;
}

Conditions made() {
  return {{"A", runs("A", {4.0, 4.0, 8.0})},
          {"B", runs("B", {12.0, 12.0, 16.0})},
          {"C", runs("C", {8.0, 10.0, 12.0})},
          {"C'", runs("C'", {7.0, 9.0, 11.0})},
          {"C+", runs("C+", {6.0, 7.0, 11.0})}};
}

const Number& kError = kNumbers[index_of("rms_error_mm")];

TEST(ConditionsTest, ADifferenceIsTakenWithinEachRepeat) {
  const Conditions sut = made();
  const Estimate following = change(sut, "C", "C'", kError);
  EXPECT_EQ(following.values, (std::vector<double>{-1.0, -1.0, -1.0}));
  EXPECT_EQ(following.mean, -1.0);
  // What is the same in every repeat has no width, however much the conditions vary.
  EXPECT_EQ(following.interval95, (std::pair{-1.0, -1.0}));
  EXPECT_EQ(change(sut, "C'", "C+", kError).values, (std::vector<double>{-1.0, -2.0, 0.0}));
}

TEST(ConditionsTest, AShareIsTakenWithinEachRepeat) {
  const Conditions sut = made();
  EXPECT_EQ(restored(sut, "C", kError).values, (std::vector<double>{0.5, 0.25, 0.5}));
  EXPECT_EQ(restored(sut, "A", kError).values, (std::vector<double>{1.0, 1.0, 1.0}));
  EXPECT_EQ(restored(sut, "B", kError).values, (std::vector<double>{0.0, 0.0, 0.0}));
}

// t(0.975, 2) = 4.302653; s of 8, 10, 12 is 2.
TEST(ConditionsTest, TheIntervalIsStudents) {
  const Estimate sut = measured(made(), "C", kError);
  ASSERT_TRUE(sut.interval95);
  const double half = 4.302653 * 2.0 / std::sqrt(3.0);
  EXPECT_NEAR(sut.interval95->first, 10.0 - half, 1e-5);
  EXPECT_NEAR(sut.interval95->second, 10.0 + half, 1e-5);
}

TEST(ConditionsTest, WhatWasNotFoundDoesNotCount) {
  const Estimate two = estimate({1.0, kNone, 3.0});
  EXPECT_EQ(two.mean, 2.0);
  EXPECT_EQ(two.values.size(), 2u);
  const Estimate one = estimate({kNone, 3.0});
  EXPECT_EQ(one.mean, 3.0);
  EXPECT_FALSE(one.interval95) << "one value has no interval";
  EXPECT_TRUE(std::isnan(estimate({kNone}).mean));
}

TEST(ConditionsTest, ANumberOfTheMotorBelongsToTheConditionsInWhichItActs) {
  const Number& share = kNumbers[index_of("cancelled_share")];
  EXPECT_FALSE(has("B", share));
  EXPECT_TRUE(has("C'", share));
  EXPECT_TRUE(has("B", kNumbers[index_of("crossover_reference_hz")]));
}

LoopResult with_finding(const char* where, bool augmented = true) {
  LoopResult result;
  Round round;
  round.augmented = augmented;
  round.verdict.findings = {{"tone", "", where, 0.5, 2.0, 1.0, "it is there"}};
  round.model.rate_hz = 3.0;
  result.followed_model.rate_hz = 2.0;
  result.rounds = {round};
  return result;
}

// Forces left in place of the errors.
Conditions left(const std::vector<double>& c, const std::vector<double>& c_prime,
                const std::vector<double>& c_plus) {
  Conditions out = made();
  const auto set = [&](const char* label, const std::vector<double>& forces_n) {
    for (std::size_t r = 0; r < 3; ++r) out[label][r].forces.left_n = forces_n[r];
  };
  set("C", c);
  set("C'", c_prime);
  set("C+", c_plus);
  return out;
}

TEST(LoopDecisionTest, AModelThatLeavesMoreThanEitherYardstickIsNotKept) {
  const std::vector<double> low{1.0, 1.1, 0.9};
  const std::vector<double> middle{2.0, 2.1, 1.9};
  const std::vector<double> high{3.0, 3.1, 2.9};
  const LoopResult result = with_finding(kBody);
  const LoopDecision kept = decide(left(high, middle, low), result);
  EXPECT_TRUE(kept.kept());
  EXPECT_EQ(chosen_model(result, kept).rate_hz, 3.0);
  // The tracking error of `made` is smallest with C+ in each of these.
  const LoopDecision worse_than_followed = decide(left(high, low, middle), result);
  EXPECT_FALSE(worse_than_followed.kept());
  EXPECT_EQ(chosen_model(result, worse_than_followed).rate_hz, 2.0) << "that of C'";
  const LoopDecision worse_than_both = decide(left(low, middle, high), result);
  EXPECT_FALSE(worse_than_both.kept());
  EXPECT_STREQ(worse_than_both.model_of, "C");
}

TEST(LoopDecisionTest, AMeanGainWhoseIntervalHoldsNoneIsNotKept) {
  const LoopResult result = with_finding(kBody);
  const LoopDecision sut = decide(left({3.0, 3.0, 3.0}, {2.0, 2.0, 2.0}, {1.0, 2.9, 1.0}), result);
  EXPECT_LT(sut.over_c_prime.mean, 0.0);
  EXPECT_FALSE(sut.kept());
  EXPECT_STREQ(sut.model_of, "C'");
  // C' has to be worth its work, too.
  const LoopDecision neither =
      decide(left({3.0, 3.0, 3.0}, {2.0, 3.9, 2.0}, {1.0, 3.9, 1.0}), result);
  EXPECT_STREQ(neither.model_of, "C");
}

TEST(LoopDecisionTest, WhatCPlusMakesWorseIsGivenNextToItsGain) {
  Conditions conditions = left({3.0, 3.1, 2.9}, {2.0, 2.1, 1.9}, {1.0, 1.1, 0.9});
  for (TrialRun& run : conditions.at("C+")) run.metrics.rms_error_mm += 20.0;
  const LoopDecision sut = decide(conditions, with_finding(kBody));
  EXPECT_TRUE(sut.kept());
  ASSERT_EQ(sut.harms.size(), 2u);
  EXPECT_STREQ(sut.harms[0].number->key, "rms_error_mm");
  EXPECT_STREQ(sut.harms[0].than, "C");
  EXPECT_STREQ(sut.harms[1].than, "C'");
  EXPECT_GT(sut.harms[1].rise.interval95->first, 0.0);
}

TEST(LoopDecisionTest, WhatTheMotorDoesAboutTheDriveIsJudgedByTheTracking) {
  Conditions more_force = left({1.0, 1.1, 0.9}, {1.0, 1.1, 0.9}, {2.0, 2.1, 1.9});
  more_force.at("C+") = runs("C+", {5.0, 7.0, 9.0});
  for (TrialRun& run : more_force.at("C+")) run.forces.left_n = 2.0;
  EXPECT_FALSE(decide(more_force, with_finding(kBody)).kept());
  const LoopDecision sut = decide(more_force, with_finding(kDrive));
  EXPECT_STREQ(sut.measure->key, "rms_error_mm");
  EXPECT_TRUE(sut.kept());
}

TEST(LoopDecisionTest, WithoutAnAugmentedModelNothingIsKept) {
  EXPECT_FALSE(
      decide(left({3.0, 3.0, 3.0}, {2.0, 2.0, 2.0}, {1.0, 1.0, 1.0}), with_finding(kBody, false))
          .kept());
}

}  // namespace
}  // namespace stillhand::close_the_loop::conditions_test
