// SPDX-License-Identifier: Apache-2.0
// Means, paired differences and shares over the repeats, from numbers that are made up.
#include "apps/close_the_loop/conditions.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "apps/session/paper_table.hpp"

namespace stillhand::close_the_loop {
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

const Measure& kError = kMeasures[kRmsError];

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

TEST(ConditionsTest, EveryMeasureHasAKeyOfItsOwnAndThePapersComeFirst) {
  std::set<std::string> keys;
  for (const Measure& measure : kMeasures) keys.insert(measure.key);
  EXPECT_EQ(keys.size(), kMeasures.size());
  for (std::size_t k = 0; k < session::kMetrics.size(); ++k) {
    EXPECT_STREQ(kMeasures[k].key, session::kMetrics[k].key);
  }
  EXPECT_STREQ(kMeasures[kForceLeft].key, "force_left_n");
  EXPECT_STREQ(kMeasures[kReference].key, "crossover_reference_hz");
  EXPECT_FALSE(has("B", kMeasuresOfAll));
  EXPECT_TRUE(has("C'", kMeasuresOfAll));
}

}  // namespace
}  // namespace stillhand::close_the_loop
