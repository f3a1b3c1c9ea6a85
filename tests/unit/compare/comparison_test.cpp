// SPDX-License-Identifier: Apache-2.0
#include "apps/compare/core/comparison.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "apps/compare/findings.hpp"

namespace stillhand::compare::comparison_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kError = 0;
constexpr std::size_t kDwell = 1;

Condition condition(const std::string& label, std::vector<double> error,
                    std::vector<double> dwell = {}) {
  return {label, {std::move(error), std::move(dwell), {}}};
}

/// Four people: A 10, B 30 to 36 mm.
Side side(std::vector<Condition> options, double first_a = 10.0) {
  Side out{"one", {condition("A", {first_a, 10.0, 11.0, 9.0}), condition("B", {30, 32, 34, 36})}};
  for (Condition& option : options) out.conditions.push_back(std::move(option));
  return out;
}

// Eq. CO-1 by hand: B 33, A 10, X 18: 15/23.
TEST(ComparisonTest, StatesTheRestoredShareAndWhomItHarms) {
  const Comparison sut = compared({side({condition("C", {10, 12, 14, 36.5})})});
  ASSERT_THAT(sut.options, SizeIs(1));
  const Outcome& outcome = sut.options[0].outcomes[kError];
  EXPECT_DOUBLE_EQ(outcome.mean, 18.125);
  EXPECT_DOUBLE_EQ(*outcome.restored.share, (33.0 - 18.125) / 23.0);
  EXPECT_EQ(outcome.harmed, 1u);
  EXPECT_DOUBLE_EQ(*outcome.least_gain, -0.5);
}

// A and B of 10 and 9 mm, of 0.4 and 0.5: nothing was lost that could be restored.
TEST(ComparisonTest, RestoresNothingWhereTheMotionDidNoHarm) {
  const Side calm{"one",
                  {condition("A", {10.0, 10.0}, {0.4, 0.4}), condition("B", {9.0, 9.5}, {0.5, 0.5}),
                   condition("C", {9.5, 9.0}, {0.45, 0.45})}};
  const Comparison sut = compared({calm});
  for (const std::size_t m : {kError, kDwell}) {
    EXPECT_FALSE(sut.options.at(0).outcomes[m].restored.share) << m;
    EXPECT_FALSE(sut.options.at(0).outcomes[m].restored.interval) << m;
  }
}

TEST(ComparisonTest, LowerIsBetterForTheErrorAndHigherForTheDwellRatio) {
  Side both = side({condition("C", {20, 21, 22, 23}, {0.3, 0.3, 0.3, 0.35}),
                    condition("E", {25, 26, 27.5, 28}, {0.4, 0.5, 0.4, 0.45})});
  const Comparison sut = compared({both});
  EXPECT_EQ(sut.options[*sut.rankings[kError].best].condition, "C");
  EXPECT_EQ(sut.options[*sut.rankings[kDwell].best].condition, "E");
  for (const std::size_t m : {kError, kDwell}) {
    const Contrast& contrast = sut.rankings[m].contrasts.at(0);
    EXPECT_GT(contrast.better_by, 0.0);
    EXPECT_GT(contrast.low, 0.0);
    EXPECT_LT(contrast.low, contrast.better_by);
    EXPECT_GT(contrast.high, contrast.better_by);
  }
}

// Eq. CO-2: paired where A is the same of at least half of the people, bit for bit.
TEST(ComparisonTest, TheSamePeopleArePaired) {
  const auto c = condition("C", {20, 24, 28, 32});
  const auto better = condition("C", {19, 23.1, 26.8, 31});  // by about 1 each
  const Comparison same = compared({side({c}), side({better})});
  EXPECT_TRUE(same.rankings[kError].contrasts.at(0).same_people);
  EXPECT_LT(same.rankings[kError].contrasts.at(0).p, 0.001);
  EXPECT_TRUE(same_people(side({c}), side({c}, 10.000001)));  // one of four differs
  Side others = side({better});
  for (double& value : others.conditions[0].values[0]) value += 1e-6;
  const Comparison other = compared({side({c}), others});
  EXPECT_FALSE(other.rankings[kError].contrasts.at(0).same_people);
  EXPECT_GT(other.rankings[kError].contrasts.at(0).p, 0.5);
  EXPECT_THAT(other.rankings[kError].as_good, ElementsAre(0));
}

TEST(ComparisonTest, HolmCountsTheContrasts) {
  const auto base = condition("C", {20, 24, 28, 32});
  const auto worse = condition("E", {21, 25.5, 28.5, 33.5});
  const double alone = compared({side({base, worse})}).rankings[kError].contrasts.at(0).p;
  const auto far = condition("F", {31, 33, 40, 41});
  const Comparison three = compared({side({base, worse, far})});
  const auto& both = three.rankings[kError].contrasts;
  ASSERT_THAT(both, SizeIs(2));
  // The larger of two p stays, the smaller one counts twice.
  EXPECT_LT(both[1].p, alone);
  EXPECT_DOUBLE_EQ(both[0].p, alone);
  const double far_alone = compared({side({base, far})}).rankings[kError].contrasts.at(0).p;
  EXPECT_DOUBLE_EQ(both[1].p, 2.0 * far_alone);
}

TEST(ComparisonTest, OnePersonSaysNothingAboutOthers) {
  Side lab{"lab", {condition("A", {10}), condition("B", {30}), condition("C", {20})}};
  Side second{"lab2", {condition("C", {25})}};
  const Comparison sut = compared({lab, second});
  EXPECT_THAT(sut.rankings[kError].contrasts, SizeIs(0));
  EXPECT_THAT(sut.rankings[kError].as_good, ElementsAre(1));
  EXPECT_THAT(findings(sut).at(0), HasSubstr("says nothing about other people"));
  EXPECT_FALSE(sut.options[1].outcomes[kError].restored.share);
}

TEST(ComparisonTest, UnknownValuesAreLeftOut) {
  const Comparison sut = compared({side({condition("C", {20, kUnknown, 22, 24})})});
  EXPECT_EQ(sut.options[0].outcomes[kError].people, 3u);
  EXPECT_DOUBLE_EQ(sut.options[0].outcomes[kError].mean, 22.0);
  EXPECT_EQ(sut.options[0].outcomes[kDwell].people, 0u);
  EXPECT_FALSE(sut.rankings[kDwell].best);
}

TEST(FindingsTest, SayWhatWhomAndHowSure) {
  const Comparison sut =
      compared({side({condition("C", {20, 21, 22, 23}), condition("E", {25, 26, 27.5, 28})})});
  const std::string text = findings(sut).at(0);
  EXPECT_THAT(text, HasSubstr("one, C is the best on average (21.5 mm, 4 people)"));
  EXPECT_THAT(text, HasSubstr("0 of 4 are worse off"));
  EXPECT_THAT(text, HasSubstr("The next is one, E: the difference is 5.12 mm"));
  EXPECT_THAT(text, HasSubstr("the same people"));
}

}  // namespace
}  // namespace stillhand::compare::comparison_test
