// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/row_clock.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "apps/libraries/measurement/row_count.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/signal/random.hpp"

namespace stillhand::measurement::row_clock_test {

recording::Recording at(std::vector<double> time_s) {
  recording::Recording rows;
  rows.source = "ride.csv";
  rows.columns = {{"f", "N", std::vector<double>(time_s.size())}};
  rows.time_s = std::move(time_s);
  estimate_timing(rows);
  return rows;
}

// Times of `count` samples at a rate, as a program prints them with so many digits.
std::vector<double> printed(double rate_hz, int count, double resolution_s) {
  std::vector<double> time_s;
  for (int i = 0; i < count; ++i) {
    time_s.push_back(std::round(i / rate_hz / resolution_s) * resolution_s);
  }
  return time_s;
}

std::vector<double> jittered(double rate_hz, int count, double jitter_periods) {
  signal::Gaussian random(7, 0);
  std::vector<double> time_s;
  for (int i = 0; i < count; ++i) {
    time_s.push_back((i + jitter_periods * (2.0 * random.uniform() - 1.0)) / rate_hz);
  }
  return time_s;
}

TEST(RowClockTest, PrintedStampsGiveTheirRateAndWholePlaces) {
  struct Case {
    double rate_hz;
    int count;
    double resolution_s;
    double wanted_hz;
    double within_hz = 0.0;
    double since_s = 0.0;
  };
  const Case cases[]{
      {100.0, 1000, 1e-6, 100.0},
      {128.0, 2000, 1e-3, 128.0},
      {700.0, 5000, 1e-3, 700.0},                 // in steps of 1 and 2 ms
      {1000.0, 3000, 1e-3, 1000.0, 0.0, 1.7e9},   // since 1970
      {1.0 / 3600.01, 1000, 1e-3, 1.0 / 3600.0},  // 0.3 % of a period off at the end: whole seconds
      // 2 % of a period over 999 periods of 100 Hz are 0.002 Hz.
      {100.0019, 1000, 1e-9, 100.0},
      {100.0021, 1000, 1e-9, 100.0021, 1e-6},
      // A microsecond over 20,000 periods of 1.6384 ms is 3e-8.
      {610.3515625, 20'000, 1e-6, 610.3515625, 610.0 * 3e-8},
      // The slope is good to 1 ms / 5000^1.5, 2e-6 of the period, and 0.3 Hz are 4e-4.
      {700.3, 5000, 1e-3, 700.3, 0.01},
  };
  for (const Case& each : cases) {
    std::vector<double> time_s = printed(each.rate_hz, each.count, each.resolution_s);
    for (double& t : time_s) t += each.since_s;
    const RowPlaces sut = place_rows(at(time_s));
    EXPECT_NEAR(sut.rate_hz, each.wanted_hz, each.within_hz) << each.rate_hz;
    EXPECT_FALSE(sut.as_stamped) << each.rate_hz;
    ASSERT_EQ(sut.stretches.size(), 1u);
    EXPECT_EQ(sut.stretches[0].grid_samples, static_cast<std::size_t>(each.count));
    EXPECT_EQ(sut.places.front(), 0.0);
    EXPECT_EQ(sut.places.back(), each.count - 1.0) << each.rate_hz;
    // Whole ms of 128 Hz: half of the rows are more than 3 % of a period off, and yet on the grid.
    if (each.rate_hz == 128.0) {
      EXPECT_GT(sut.jitter_periods, 0.02);
    }
  }
}

// Ticks of 1 ms have a resolution of one period too; here the steps of two are gaps.
TEST(RowClockTest, RowsMissingFromTicksAreGaps) {
  for (const int every : {60, 7}) {
    signal::Gaussian random(9, 0);
    std::vector<double> time_s;
    for (int i = 0; i < 3000; ++i) {
      if (i == 0 || random.uniform() * every > 1.0) time_s.push_back(i * 1e-3);
    }
    const RowPlaces sut = place_rows(at(time_s));
    EXPECT_EQ(sut.rate_hz, 1000.0);
    EXPECT_FALSE(sut.as_stamped);
    EXPECT_EQ(sut.places.back(), std::round(time_s.back() * 1000.0));
  }
}

// Uniform jitter of +-j periods has a median magnitude of j/2.
TEST(RowClockTest, JitterBelowTwoPercentIsIgnoredAndAboveItIsBelieved) {
  const RowPlaces small = place_rows(at(jittered(100.0, 4000, 0.03)));
  EXPECT_FALSE(small.as_stamped);
  EXPECT_NEAR(small.jitter_periods, 0.015, 0.002);
  const RowPlaces large = place_rows(at(jittered(100.0, 4000, 0.10)));
  EXPECT_TRUE(large.as_stamped);
  EXPECT_NEAR(large.jitter_periods, 0.05, 0.005);
  EXPECT_EQ(large.rate_hz, 100.0);
  EXPECT_NEAR(large.places[2000], 2000.0, 0.2);
  EXPECT_NE(large.places[2000], 2000.0);
}

// Two rows then lie in one period of the grid: counting them would move all that follow.
TEST(RowClockTest, OneLateRowDoesNotMoveTheOthers) {
  std::vector<double> time_s = printed(100.0, 400, 1e-3);
  time_s[200] += 0.007;
  const RowPlaces sut = place_rows(at(time_s));
  EXPECT_NEAR(sut.places[200], 200.7, 1e-6);
  EXPECT_NEAR(sut.places[399], 399.0, 1e-6);
  EXPECT_EQ(sut.stretches[0].grid_samples, 400u);
}

TEST(RowClockTest, AShortGapIsCountedAndALongOneCuts) {
  std::vector<double> time_s;
  for (int i = 0; i < 1000; ++i) {
    const bool short_gap = i >= 300 && i < 305;  // 5 rows, the longest bridge at 100 Hz
    const bool long_gap = i >= 600 && i < 606;
    if (!short_gap && !long_gap) time_s.push_back(i * 0.01);
  }
  const RowPlaces sut = place_rows(at(time_s));
  ASSERT_EQ(sut.stretches.size(), 2u);
  EXPECT_EQ(sut.stretches[0].grid_samples, 600u);
  EXPECT_EQ(sut.stretches[0].end_row, 595u);
  EXPECT_EQ(sut.places[299], 299.0);
  EXPECT_EQ(sut.places[300], 305.0);
  EXPECT_DOUBLE_EQ(sut.stretches[1].start_s, 6.06);
  EXPECT_EQ(sut.lost_between, 6.0);
  EXPECT_FALSE(sut.as_stamped);
}

TEST(RowClockTest, TheLongestBridgeIsThreeRowsOrFiftyMilliseconds) {
  EXPECT_EQ(longest_bridge(1.0), 3);
  EXPECT_EQ(longest_bridge(60.0), 3);
  EXPECT_EQ(longest_bridge(100.0), 5);
  EXPECT_EQ(longest_bridge(1000.0), 50);
  EXPECT_EQ(longest_bridge(1e9), 1000);
}

TEST(RowCountTest, ARowIsCountedFromTheMeanLatenessOfTheRowsBefore) {
  const auto last_place = [](const std::vector<double>& time_s) {
    return count_rows(time_s, 1.0).places.back();
  };
  // Late by 0, 0.4 and 0.4: half a period more than their mean is 0.767.
  EXPECT_EQ(last_place({0, 1.4, 2.4, 3.76}), 3.0);
  EXPECT_EQ(last_place({0, 1.4, 2.4, 3.77}), 4.0);
  // Behind 100 rows each one counts by a hundredth: 0.4 (1 - 0.99^50) + 0.5 = 0.658.
  std::vector<double> time_s = printed(1.0, 101, 1.0);
  for (int i = 101; i < 151; ++i) time_s.push_back(i + 0.4);
  time_s.push_back(151.65);
  EXPECT_EQ(last_place(time_s), 151.0);
  time_s.back() = 151.67;
  EXPECT_EQ(last_place(time_s), 152.0);
  EXPECT_FALSE(count_rows({0, 1, 1.5, 3}, 1.0).crowded);
  EXPECT_TRUE(count_rows({0, 1, 1.49, 3}, 1.0).crowded);
}

// The squares of five places about their mean sum up to 10; row 3 lies 1 from it.
TEST(RowCountTest, ThePeriodIsTheSlopeOfAllStretchesWithAPhaseForEach) {
  const RowCount sut = count_rows({0, 1, 2, 3.08, 4}, 1.0);
  EXPECT_DOUBLE_EQ(sut.period_s, 1.008);
  EXPECT_NEAR(sut.median_periods, 2.0 - 2.0 / 1.008, 1e-12);
  EXPECT_NEAR(sut.range_periods, 1.0 - 0.92 / 1.008, 1e-12) << "from row 4 to row 3";
  EXPECT_DOUBLE_EQ(count_rows({0, 1, 2, 3, 4, 99.5, 100.5, 101.5, 102.59, 103.5}, 1.0).period_s,
                   1.0045);
  EXPECT_TRUE(count_rows({0, 1, 2, 3.11, 4}, 1.0).lost) << "a hundredth from what was counted";
  const std::vector<double> restarted{0, 1, 2, 3.09, 4, 6.5, 7.5, 8.5, 9.5, 10.5};
  EXPECT_DOUBLE_EQ(period_between_gaps(restarted, count_rows(restarted, 1.0)), 1.0045);
}

// After a restart in the middle of a period the rows lie between the samples.
TEST(RowClockTest, AGapOfHalfAPeriodMoreMakesTheGridMissTheRows) {
  std::vector<double> time_s;
  for (int i = 0; i < 1000; ++i) time_s.push_back(i * 0.01 + (i < 500 ? 0.0 : 0.025));
  const RowPlaces sut = place_rows(at(time_s));
  EXPECT_TRUE(sut.as_stamped);
  ASSERT_EQ(sut.stretches.size(), 1u);
  EXPECT_EQ(sut.rate_hz, 100.0);
  EXPECT_NEAR(sut.places.back(), 1001.5, 1e-6);
}

TEST(RowClockTest, TimesWithoutARateAreRefused) {
  EXPECT_THROW((void)place_rows(at({-1.7e308, 0.0, 1.7e308})), ConfigError);
  EXPECT_THROW((void)place_rows(at({0.0, 5e-324, 1e-323})), ConfigError);
  EXPECT_THROW((void)place_rows(at({0.0, 1e-310, 2e-310})), ConfigError);
}

}  // namespace stillhand::measurement::row_clock_test
