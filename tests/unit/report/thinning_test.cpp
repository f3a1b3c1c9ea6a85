// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/thinning.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "apps/libraries/report/excerpt.hpp"

namespace stillhand::report::thinning_test {

using testing::ElementsAre;

constexpr double kWidth_px = 100.0;

TEST(ThinLineTest, EachColumnKeepsItsFirstLastLowestAndHighest) {
  const std::vector<double> x{0.0, 0.2, 0.4, 0.6, 0.8, 1.5, 1.6, 1.7};
  const std::vector<double> y{0.0, 5.0, 1.0, -5.0, 2.0, 9.0, 9.0, 9.0};
  EXPECT_THAT(thin_line(x, y, y, kWidth_px), ElementsAre(0, 1, 3, 4, 5, 7));
}

TEST(ThinLineTest, ABandKeepsTheLowestOfItsLowerAndTheHighestOfItsUpperEdge) {
  const std::vector<double> x{0.0, 0.1, 0.2, 0.3, 0.4};
  const std::vector<double> low{0.0, -1.0, -9.0, -1.0, 0.0};
  const std::vector<double> high{1.0, 8.0, 2.0, 3.0, 1.0};
  EXPECT_THAT(thin_line(x, low, high, kWidth_px), ElementsAre(0, 1, 2, 4));
}

TEST(ThinLineTest, WhatLiesOutOfSightCountsAsOneColumnOnEachSide) {
  const std::vector<double> x{-30.0, -2.0, -0.1, 0.0, 99.9, 100.0, 101.0, 300.0};
  const std::vector<double> y(x.size(), 1.0);
  EXPECT_THAT(thin_line(x, y, y, kWidth_px), ElementsAre(0, 2, 3, 4, 5, 7));
}

TEST(ThinLineTest, ACurveThatTurnsBackKeepsEveryPoint) {
  const std::vector<double> x{0.0, 0.3, 0.2, 0.4};
  const std::vector<double> y{1.0, 1.0, 1.0, 1.0};
  EXPECT_THAT(thin_line(x, y, y, kWidth_px), ElementsAre(0, 1, 2, 3));
}

TEST(ThinLineTest, NothingGivesNothing) { EXPECT_TRUE(thin_line({}, {}, {}, kWidth_px).empty()); }

TEST(ThinPointsTest, OfPointsOnOneSquareTheFirstStays) {
  const std::vector<double> x{0.1, 0.9, 1.1, 0.2};
  const std::vector<double> y{5.1, 5.9, 5.5, 6.0};
  EXPECT_THAT(thin_points(x, y), ElementsAre(0, 2, 3));
}

// Ten seconds, or 40 cycles where these hold fewer than 4 or more than 100; all, if there are
// fewer.
TEST(ExcerptTest, AFigureShowsTenSecondsOrFortyCycles) {
  const auto samples = [](double frequency_hz, double rate_hz) {
    std::vector<double> y;
    for (int i = 0; i < 5000; ++i) y.push_back(std::sin(6.2832 * frequency_hz / rate_hz * i));
    return static_cast<double>(excerpt_length(y, rate_hz));
  };
  for (const double frequency_hz : {0.0, 0.5, 9.5}) EXPECT_EQ(samples(frequency_hz, 100.0), 1000.0);
  EXPECT_NEAR(samples(0.35, 10.0), 40.0 / 0.35 * 10.0, 20.0);
  EXPECT_NEAR(samples(10.5, 100.0), 40.0 / 10.5 * 100.0, 4.0);
  EXPECT_EQ(samples(0.05, 10.0), 5000.0);
}

}  // namespace stillhand::report::thinning_test
