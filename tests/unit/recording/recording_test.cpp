// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/recording.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace stillhand::recording::recording_test {
namespace {

Recording at(std::vector<double> time_s) {
  Recording recording;
  recording.time_s = std::move(time_s);
  estimate_timing(recording);
  return recording;
}

TEST(RecordingTest, TwoRowsGiveARate) {
  const Recording sut = at({1.0, 1.25});
  EXPECT_DOUBLE_EQ(sut.rate_hz, 4.0);
  EXPECT_TRUE(sut.gaps.empty());
}

TEST(RecordingTest, FindsTheRowsThatAreMissing) {
  std::vector<double> time_s;
  for (int row = 0; row < 1000; ++row) {
    if (row != 200 && (row < 500 || row > 549)) time_s.push_back(row * 0.01);
  }
  const Recording sut = at(time_s);
  // Sums of 949 steps of 0.01 s: rounding below 1e-12 of the rate of 100 Hz.
  EXPECT_NEAR(sut.rate_hz, 100.0, 1e-10 * 100.0);
  ASSERT_EQ(sut.gaps.size(), 2u);
  EXPECT_EQ(sut.gaps[0].after_row, 199u);
  EXPECT_EQ(sut.gaps[0].missing_rows, 1);
  EXPECT_EQ(sut.gaps[1].after_row, 498u);  // row 499 of the clock, one row already gone
  EXPECT_EQ(sut.gaps[1].missing_rows, 50);
}

TEST(RecordingTest, RoundedTimesDoNotBendTheRate) {
  // 128 Hz printed in whole ms: steps of 7 and 8 ms.  The span is rounded by 1 ms at most, so the
  // rate is right to 1 ms / 10 s.
  std::vector<double> time_s;
  for (int row = 0; row <= 1280; ++row) time_s.push_back(std::round(row * 1000.0 / 128.0) / 1000.0);
  const Recording sut = at(time_s);
  EXPECT_NEAR(sut.rate_hz, 128.0, 128.0 * 1e-4);
  EXPECT_TRUE(sut.gaps.empty());
}

TEST(RecordingTest, GapsMoreThanHalfTheTimeDoNotBendTheRate) {
  std::vector<double> time_s;
  for (int burst = 0; burst < 10; ++burst) {
    for (int row = 0; row < 10; ++row) time_s.push_back(burst * 5.0 + row * 0.001);
  }
  const Recording sut = at(time_s);
  EXPECT_NEAR(sut.rate_hz, 1000.0, 1e-6 * 1000.0);
  ASSERT_EQ(sut.gaps.size(), 9u);
  EXPECT_EQ(sut.gaps[0].missing_rows, 4990);  // 4.991 s
}

TEST(RecordingTest, AGapOfMorePeriodsThanAnIntegerCountsIsStillAGap) {
  const Recording sut = at({0.0, 1e-3, 2e-3, 1e300});
  ASSERT_EQ(sut.gaps.size(), 1u);
  EXPECT_EQ(sut.gaps[0].after_row, 2u);
  EXPECT_EQ(sut.gaps[0].missing_rows, (std::int64_t{1} << 53) - 1);
}

}  // namespace
}  // namespace stillhand::recording::recording_test
