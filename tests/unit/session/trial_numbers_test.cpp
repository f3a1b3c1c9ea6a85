// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/core/trial_numbers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

namespace stillhand::session::trial_numbers_test {
namespace {

TEST(TrialNumbersTest, ARowReadsThePlaceThatItNamesInItsUnit) {
  TrialNumbers trial;
  trial.metrics.dwell_ratio = 0.25;
  trial.forces.motor_n = 3.0;
  trial.counterforce_delay_s = 0.004;
  EXPECT_EQ(kNumbers[index_of("dwell_ratio")].of(trial), 0.25);
  EXPECT_EQ(kNumbers[index_of("motor_force_n")].of(trial), 3.0);
  EXPECT_EQ(kNumbers[index_of("counterforce_delay_ms")].of(trial), 4.0);
  EXPECT_TRUE(std::isnan(kNumbers[index_of("cancelled_share")].of(trial)));
}

TEST(TrialNumbersTest, EveryRowHasAKeyOfItsOwnAndAUnit) {
  std::set<std::string> keys;
  for (const Number& each : kNumbers) {
    EXPECT_TRUE(keys.insert(each.key).second) << each.key;
    EXPECT_FALSE(each.unit().empty()) << each.key;
  }
  EXPECT_EQ(kMetrics[0].unit(), "mm");
  EXPECT_EQ(kMetrics[1].unit(), "-");
}

// `compare` reads a sample, an export a metric.
TEST(TrialNumbersTest, WhatIsReadElsewhereHasTheShapeForIt) {
  for (const Number& each : kNumbers) {
    EXPECT_TRUE(!each.is_judged() || each.shape == Shape::kSample) << each.key;
    if ((each.in & kExport) == 0) continue;
    EXPECT_NE(each.place.metric, nullptr) << each.key;
    EXPECT_STRNE(each.name, "") << each.key;
    EXPECT_STRNE(each.meaning, "") << each.key;
  }
}

}  // namespace
}  // namespace stillhand::session::trial_numbers_test
