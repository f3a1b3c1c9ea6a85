// SPDX-License-Identifier: Apache-2.0
#include "services/core/statistics/descriptive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "services/core/contract/config_error.hpp"
#include "tests/support/statistics_golden.hpp"

namespace stillhand::statistics::descriptive_test {
namespace {

namespace golden = stillhand::golden::statistics;
using support::agrees;
using support::golden_trials;

TEST(DescriptiveTest, EqualsR) {
  for (const auto& want : golden::kDescriptions) {
    SCOPED_TRACE("set " + std::to_string(want.set) + ", metric " + std::to_string(want.metric));
    const std::vector<double> values = golden_trials(want.set).all(want.metric);
    EXPECT_TRUE(agrees(mean(values), want.mean));
    EXPECT_TRUE(agrees(standard_deviation(values), want.deviation));
    EXPECT_TRUE(agrees(median(values), want.median));
    EXPECT_TRUE(agrees(mean_interval(values).low, want.low_95));
    EXPECT_TRUE(agrees(mean_interval(values).high, want.high_95));
    EXPECT_TRUE(agrees(mean_interval(values, 0.99).low, want.low_99));
    EXPECT_TRUE(agrees(mean_interval(values, 0.99).high, want.high_99));
    for (std::size_t i = 0; i < std::size(golden::kProbabilities); ++i) {
      EXPECT_TRUE(agrees(quantile(values, golden::kProbabilities[i]), want.quantiles[i]));
    }
    const BoxPlot sut = box_plot(values);
    EXPECT_TRUE(agrees(sut.lower_quartile, want.lower_quartile));
    EXPECT_TRUE(agrees(sut.median, want.median));
    EXPECT_TRUE(agrees(sut.upper_quartile, want.upper_quartile));
    EXPECT_EQ(sut.minimum, want.quantiles[0]);
    EXPECT_EQ(sut.maximum, want.quantiles[6]);
  }
}

TEST(DescriptiveTest, QuantilesInterpolateBetweenSortedValues) {
  const std::vector<double> values = {40.0, 10.0, 30.0, 20.0};
  // Eq. ST-2: position 3 * 0.25 = 0.75 between the first and the second.
  EXPECT_EQ(quantile(values, 0.25), 17.5);
  EXPECT_EQ(median(values), 25.0);
  EXPECT_EQ(quantile(values, 0.0), 10.0);
  EXPECT_EQ(quantile(values, 1.0), 40.0);
  EXPECT_EQ(quantile({7.0}, 0.3), 7.0);
}

TEST(DescriptiveTest, DeviationSurvivesALargeOffsetAndExtremeScale) {
  // 2^40 + {-1, 0, 1} and 2^-600 times {-1, 0, 1} are exact; both deviations are those of -1, 0, 1.
  const double offset = std::ldexp(1.0, 40), tiny = std::ldexp(1.0, -600);
  EXPECT_EQ(standard_deviation({offset - 1.0, offset, offset + 1.0}), 1.0);
  EXPECT_EQ(standard_deviation({-tiny, 0.0, tiny}), tiny);
  EXPECT_EQ(standard_deviation({3.0, 3.0}), 0.0);
  // Ten times 0.1/10 is below 0.1 by an ulp.
  EXPECT_EQ(mean(std::vector<double>(10, 0.1)), 0.1);
}

TEST(DescriptiveTest, WhatCannotBeDescribedIsRefused) {
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  EXPECT_THROW(mean({}), ConfigError);
  EXPECT_THROW(median({}), ConfigError);
  EXPECT_THROW(box_plot({}), ConfigError);
  EXPECT_THROW(standard_deviation({1.0}), ConfigError);
  EXPECT_THROW(mean_interval({1.0}), ConfigError);
  EXPECT_THROW(mean({1.0, nan}), ConfigError);
  EXPECT_THROW(median({1.0, infinite}), ConfigError);
  EXPECT_THROW(mean({1e101}), ConfigError);
  for (const double outside : {-0.001, 1.001, nan}) {
    EXPECT_THROW(quantile({1.0, 2.0}, outside), ConfigError);
  }
  for (const double outside : {0.0, 1.0, nan}) {
    EXPECT_THROW(mean_interval({1.0, 2.0}, outside), ConfigError);
  }
}

}  // namespace
}  // namespace stillhand::statistics::descriptive_test
