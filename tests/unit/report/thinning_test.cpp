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

// 50 points a column; irrational steps, so that extrema fall anywhere in a column.
std::vector<double> columns(std::size_t count) {
  std::vector<double> x(count);
  for (std::size_t i = 0; i < count; ++i) x[i] = 0.02 * static_cast<double>(i);
  return x;
}

std::vector<double> wave(std::size_t count) {
  std::vector<double> y(count);
  for (std::size_t i = 0; i < count; ++i) y[i] = std::sin(1.7 * static_cast<double>(i * i % 997));
  return y;
}

TEST(ThinLineTest, EachColumnKeepsItsFirstLastLowestAndHighest) {
  const std::vector<double> x{0.0, 0.2, 0.4, 0.6, 0.8, 1.5};
  const std::vector<double> y{0.0, 5.0, 1.0, -5.0, 2.0, 9.0};
  EXPECT_THAT(thin_line(x, y, y, kWidth_px), ElementsAre(0, 1, 3, 4, 5));
}

TEST(ThinLineTest, TheExtremaOfEveryColumnSurvive) {
  const auto x = columns(5000);
  const auto y = wave(5000);
  const auto kept = thin_line(x, y, y, kWidth_px);
  EXPECT_LE(kept.size(), 4 * 100U);
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end(), std::less_equal<>())) << "each once";
  for (int column = 0; column < 100; ++column) {
    const auto begin = y.begin() + column * 50;
    const auto [low, high] = std::minmax_element(begin, begin + 50);
    double kept_low = 2.0;
    double kept_high = -2.0;
    for (const std::size_t i : kept) {
      if (std::floor(x[i]) != column) continue;
      kept_low = std::min(kept_low, y[i]);
      kept_high = std::max(kept_high, y[i]);
    }
    ASSERT_EQ(kept_low, *low) << "column " << column;
    ASSERT_EQ(kept_high, *high) << "column " << column;
  }
}

TEST(ThinLineTest, ABandKeepsTheLowestOfItsLowerAndTheHighestOfItsUpperEdge) {
  const std::vector<double> x{0.0, 0.1, 0.2, 0.3, 0.4};
  const std::vector<double> low{0.0, -1.0, -9.0, -1.0, 0.0};
  const std::vector<double> high{1.0, 8.0, 2.0, 3.0, 1.0};
  EXPECT_THAT(thin_line(x, low, high, kWidth_px), ElementsAre(0, 1, 2, 4));
}

TEST(ThinLineTest, WhatLiesOutOfSightCountsAsOneColumnOnEachSide) {
  auto x = columns(5000);
  for (double& value : x) value = value * 10.0 - 450.0;  // -450 .. 550 px
  EXPECT_LE(thin_line(x, wave(5000), wave(5000), kWidth_px).size(), 4 * 102U);
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
