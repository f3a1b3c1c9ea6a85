// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/core/timeline.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace stillhand::dashboard {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kBegin = 1'000'000 * kMs;

Mark mark(std::int64_t at_ms, Level level, double amount, std::string subject = "topic") {
  return {kBegin + at_ms * kMs, level, 1, std::move(subject), "", amount};
}

Trial trial(std::int64_t number, Tick start_tick, Tick duration_ticks) {
  return {number, TrialPhase::kTracking, start_tick, duration_ticks, 0};
}

class TimelineTest : public ::testing::Test {
 protected:
  Timeline sut_{kBegin, kBegin + 100'000 * kMs};  // parts of 50 ms
};

TEST_F(TimelineTest, AMarkStandsAtItsInstant) {
  sut_.mark(MarkKind::kLate, mark(500, Level::kWarning, 1.5));
  sut_.mark(MarkKind::kLost, mark(100, Level::kCritical, 12.0));
  ASSERT_EQ(sut_.marks(MarkKind::kLate).size(), 1u);
  EXPECT_EQ(sut_.marks(MarkKind::kLate)[0].at_ns, kBegin + 500 * kMs);
  EXPECT_EQ(sut_.marks(MarkKind::kLost)[0].amount, 12.0);
  EXPECT_TRUE(sut_.marks(MarkKind::kEvent).empty());
}

TEST_F(TimelineTest, WhatFallsTogetherIsOneMarkAtTheFirstThatTellsTheWorst) {
  sut_.mark(MarkKind::kLate, mark(510, Level::kWarning, 1.5, "sensed"));
  sut_.mark(MarkKind::kLate, mark(520, Level::kCritical, 4.0, "raw_sample"));
  sut_.mark(MarkKind::kLate, mark(530, Level::kWarning, 2.0, "sensed"));
  sut_.mark(MarkKind::kLate, mark(560, Level::kWarning, 1.0, "sensed"));
  const auto marks = sut_.marks(MarkKind::kLate);
  ASSERT_EQ(marks.size(), 2u);
  EXPECT_EQ(marks[0].at_ns, kBegin + 510 * kMs);
  EXPECT_EQ(marks[0].count, 3u);
  EXPECT_EQ(marks[0].subject, "raw_sample");
  EXPECT_EQ(marks[0].level, Level::kCritical);
}

TEST_F(TimelineTest, HoldsABoundedNumberOfMarksWhateverTheirTimes) {
  for (std::int64_t i = -50'000; i < 200'000; i += 7) {
    sut_.mark(MarkKind::kLate, mark(i, Level::kWarning, 1.0));
  }
  sut_.mark(MarkKind::kLate,
            {std::numeric_limits<std::int64_t>::min(), Level::kWarning, 1, "", "", 1.0});
  sut_.mark(MarkKind::kLate,
            {std::numeric_limits<std::int64_t>::max(), Level::kWarning, 1, "", "", 1.0});
  EXPECT_EQ(sut_.marks(MarkKind::kLate).size(), 2001u);
}

TEST_F(TimelineTest, ATrialLastsFromItsFirstMeasuredTickToTheTickBehindItsLast) {
  sut_.announce(trial(1, 3000, 10'000), kBegin);
  for (Tick tick = 2000; tick < 20'000; ++tick) sut_.tick(tick, kBegin + tick * kMs);
  ASSERT_EQ(sut_.trials().size(), 1u);
  EXPECT_EQ(sut_.trials()[0].number, 1);
  EXPECT_EQ(sut_.trials()[0].from_ns, kBegin + 3000 * kMs);
  EXPECT_EQ(sut_.trials()[0].to_ns, kBegin + 13'000 * kMs);
}

TEST_F(TimelineTest, ATrialThatIsCutShortEndsWithTheNextWord) {
  sut_.announce(trial(1, 3000, 10'000), kBegin);
  sut_.announce(trial(1, 3000, 10'000), kBegin);  // the same again
  for (Tick tick = 2000; tick < 5000; ++tick) sut_.tick(tick, kBegin + tick * kMs);
  sut_.announce({1, TrialPhase::kIdle, 3000, 10'000, 0}, kBegin + 5000 * kMs);
  for (Tick tick = 5000; tick < 9000; ++tick) sut_.tick(tick, kBegin + tick * kMs);
  ASSERT_EQ(sut_.trials().size(), 1u);
  EXPECT_EQ(sut_.trials()[0].to_ns, kBegin + 5000 * kMs);
}

TEST_F(TimelineTest, ATrialThatNeverBeganIsNone) {
  sut_.announce(trial(1, 3000, 10'000), kBegin);
  sut_.tick(2999, kBegin);
  sut_.announce(trial(2, -5, 10'000), kBegin);
  sut_.tick(3001, kBegin);
  EXPECT_TRUE(sut_.trials().empty());
}

}  // namespace
}  // namespace stillhand::dashboard
