// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/core/timeline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <random>
#include <tuple>

namespace stillhand::dashboard::timeline_test {

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

// A process that waits is late by a little more.  A small lateness of the rig is no cause of a long
// one.
TEST_F(TimelineTest, OfWhatFallsTogetherTheCauseIsShown) {
  const auto shown = [this](std::int64_t at_ms, double rig_ms) {
    for (const auto& [topic, late_ms, waits_for] :
         {std::tuple("force", 78.0, 3), std::tuple("raw", rig_ms, 0), std::tuple("sensed", 73.0, 1),
          std::tuple("command", 75.0, 2)}) {
      Mark each = mark(at_ms, Level::kCritical, late_ms, topic);
      each.waits_for = waits_for;
      sut_.mark(MarkKind::kLate, each);
    }
    return sut_.marks(MarkKind::kLate).back().subject;
  };
  EXPECT_EQ(shown(510, 4.0), "sensed");
  EXPECT_EQ(shown(610, 72.0), "raw");
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

// Reference: marks grouped by the 2000th part of the recording in which they fall, then searched.
TEST_F(TimelineTest, InAnyOrderAPartShowsItsFirstInstantItsNumberAndItsWorst) {
  std::mt19937_64 random(41);
  std::vector<Mark> all;
  for (int i = 0; i < 3000; ++i) {
    const auto at_ms = static_cast<std::int64_t>(random() % 100'000);
    const auto level = random() % 2 == 0 ? Level::kWarning : Level::kCritical;
    all.push_back(mark(at_ms, level, static_cast<double>(i), std::to_string(i)));  // amounts differ
  }
  for (const Mark& each : all) sut_.mark(MarkKind::kAlarm, each);
  std::map<std::int64_t, std::vector<Mark>> parts;
  for (const Mark& each : all) parts[(each.at_ns - kBegin) / (50 * kMs)].push_back(each);
  const auto marks = sut_.marks(MarkKind::kAlarm);
  ASSERT_EQ(marks.size(), parts.size());
  std::size_t n = 0;
  for (const auto& [part, group] : parts) {
    const Mark& found = marks[n++];
    const auto worst = std::ranges::max_element(
        group, {}, [](const Mark& each) { return std::pair(each.level, each.amount); });
    ASSERT_EQ(found.count, group.size()) << part;
    ASSERT_EQ(found.at_ns, std::ranges::min(group, {}, &Mark::at_ns).at_ns) << part;
    ASSERT_EQ(found.subject, worst->subject) << part;
    ASSERT_EQ(found.level, worst->level) << part;
    ASSERT_EQ(found.amount, worst->amount) << part;
  }
}

TEST(TimelineLimitsTest, ARecordingWithoutALengthStillHoldsItsMarks) {
  for (const std::int64_t length_ns : {std::int64_t{0}, std::int64_t{-5}, std::int64_t{1}}) {
    Timeline sut(kBegin, kBegin + length_ns);
    EXPECT_GE(sut.end_ns(), sut.begin_ns());
    sut.mark(MarkKind::kLost, {kBegin, Level::kWarning, 1, "a", "", 1.0});
    sut.mark(MarkKind::kLost, {kBegin - 1, Level::kWarning, 1, "b", "", 2.0});
    ASSERT_EQ(sut.marks(MarkKind::kLost).size(), 1u);
    EXPECT_EQ(sut.marks(MarkKind::kLost)[0].count, 2u);
    EXPECT_EQ(sut.marks(MarkKind::kLost)[0].subject, "b");
  }
}

TEST(TimelineLimitsTest, TheNumberOfTrialsIsBounded) {
  Timeline sut(kBegin, kBegin + 100'000 * kMs);
  for (std::int64_t number = 0; number < 1500; ++number) {
    sut.announce(trial(number, number * 10, 5), kBegin + number * 10);
    sut.tick(number * 10, kBegin + number * 10);
    sut.tick(number * 10 + 5, kBegin + number * 10 + 5);
  }
  ASSERT_EQ(sut.trials().size(), 1000u);
  EXPECT_EQ(sut.trials().back().number, 999);
  EXPECT_EQ(sut.trials().back().to_ns - sut.trials().back().from_ns, 5);
}

TEST_F(TimelineTest, ATrialWhoseFirstTicksAreLostBeginsWithTheFirstThatCame) {
  sut_.announce(trial(4, 3000, 1000), kBegin);
  sut_.tick(3500, kBegin + 3500 * kMs);
  sut_.tick(9000, kBegin + 9000 * kMs);
  sut_.tick(9001, kBegin + 9001 * kMs);
  ASSERT_EQ(sut_.trials().size(), 1u);
  EXPECT_EQ(sut_.trials()[0].from_ns, kBegin + 3500 * kMs);
  EXPECT_EQ(sut_.trials()[0].to_ns, kBegin + 9000 * kMs);
}

}  // namespace stillhand::dashboard::timeline_test
