// SPDX-License-Identifier: Apache-2.0
// Time is set by hand: no test here sleeps.
#include "services/core/recording/play_clock.hpp"

#include <gtest/gtest.h>

namespace stillhand::recording::play_clock_test {
namespace {

constexpr std::int64_t kNow = 123'456'789;
constexpr std::int64_t kStart = 1'700'000'000'000'000'000;  // log times are of the system clock

TEST(PlayRateTest, ReadsThreeDecimalsAndNothingElse) {
  EXPECT_EQ(PlayRate::parse("1"), PlayRate{1000});
  EXPECT_EQ(PlayRate::parse("0.1"), PlayRate{100});
  EXPECT_EQ(PlayRate::parse(".25"), PlayRate{250});
  EXPECT_EQ(PlayRate::parse("100"), PlayRate{100'000});
  EXPECT_EQ(PlayRate::parse("12.345"), PlayRate{12'345});
  for (const char* bad : {"", ".", "0", "0.09", "100.001", "1e1", "-1", "+1", "1,5", " 1", "1 ",
                          "nan", "1.2345", "99999999999999999999", "0x1", "1.2.3"}) {
    EXPECT_FALSE(PlayRate::parse(bad)) << bad;
  }
}

TEST(PlayRateTest, ItsTextReadsBackAsItself) {
  for (std::int64_t rate = PlayRate::kSlowest; rate <= PlayRate::kFastest; rate += 37) {
    EXPECT_EQ(PlayRate::parse(PlayRate{rate}.text()), PlayRate{rate});
  }
  EXPECT_EQ(PlayRate{2500}.text(), "2.5");
  EXPECT_EQ(PlayRate{50'000}.text(), "50");
}

TEST(PlayRateTest, StepsUpAndDownEndAtTheLimits) {
  EXPECT_EQ(PlayRate{1000}.faster(), PlayRate{2000});
  EXPECT_EQ(PlayRate{1000}.slower(), PlayRate{500});
  EXPECT_EQ(PlayRate{700}.faster(), PlayRate{1000});
  EXPECT_EQ(PlayRate{700}.slower(), PlayRate{500});
  EXPECT_EQ(PlayRate{100'000}.faster(), PlayRate{100'000});
  EXPECT_EQ(PlayRate{100}.slower(), PlayRate{100});
}

TEST(PlayClockTest, AtRateOneTimeRunsAsItDidAndATenthTakesTenTimesAsLong) {
  PlayClock sut(kNow, kStart, {});
  EXPECT_EQ(sut.due(kStart), kNow);
  EXPECT_EQ(sut.due(kStart + 1), kNow + 1);
  EXPECT_EQ(sut.recorded_at(kNow + 5'000'000'000), kStart + 5'000'000'000);
  PlayClock tenth(kNow, kStart, {100});
  EXPECT_EQ(tenth.due(kStart + 1), kNow + 10);
  EXPECT_EQ(tenth.recorded_at(kNow + 9), kStart);
  EXPECT_EQ(tenth.recorded_at(kNow + 10), kStart + 1);
}

// A year at rate 100 is 3.2e18 ns recorded: the product needs more than 64 bits, and a double would
// be 256 ns off.
TEST(PlayClockTest, AYearIsExact) {
  constexpr std::int64_t kYear = 365LL * 86'400 * 1'000'000'000;
  PlayClock sut(kNow, 0, {100'000});
  EXPECT_EQ(sut.due(kYear), kNow + kYear / 100);
  EXPECT_EQ(sut.due(kYear + 1), kNow + kYear / 100 + 1);  // rounded up: never early
  PlayClock slow(kNow, 0, {100});
  EXPECT_EQ(slow.due(kYear + 1), kNow + 10 * kYear + 10);
}

// Eqs. RC-12 and RC-13: at the instant it is due the clock is there, and 1 ns before it is not.
TEST(PlayClockTest, DueAndRecordedAreEachOthersInverse) {
  for (const std::int64_t rate : {100, 333, 999, 1000, 1001, 12'345, 100'000}) {
    PlayClock sut(kNow, kStart, {rate});
    for (std::int64_t step = -3; step < 2000; step += 7) {
      const std::int64_t at = kStart + step * 997;
      const std::int64_t due = *sut.due(at);
      EXPECT_GE(sut.recorded_at(due), at) << rate;
      EXPECT_LT(sut.recorded_at(due - 1), at) << rate;
    }
  }
}

TEST(PlayClockTest, APauseMovesEverythingByItsLength) {
  PlayClock sut(kNow, kStart, {2000});
  sut.pause(kNow + 100);
  EXPECT_TRUE(sut.paused());
  EXPECT_FALSE(sut.due(kStart + 1000).has_value());
  EXPECT_EQ(sut.recorded_at(kNow + 999'999), kStart + 200);
  sut.resume(kNow + 1'000'100);
  EXPECT_EQ(sut.due(kStart + 1000), kNow + 1'000'100 + 400);
  sut.resume(kNow + 5'000'000);  // runs already
  EXPECT_EQ(sut.due(kStart + 1000), kNow + 1'000'100 + 400);
}

TEST(PlayClockTest, AnotherRateCountsFromWhereItWasSet) {
  PlayClock sut(kNow, kStart, {});
  sut.set_rate(kNow + 1000, {500});
  EXPECT_EQ(sut.recorded_at(kNow + 1000), kStart + 1000);
  EXPECT_EQ(sut.recorded_at(kNow + 3000), kStart + 2000);
  EXPECT_EQ(sut.due(kStart + 2000), kNow + 3000);
}

// A thousand changes of rate: each may round by 1 ns, none adds to another's.
TEST(PlayClockTest, ManyChangesOfRateDriftByLessThanOneNanosecondEach) {
  PlayClock sut(0, 0, {333});
  std::int64_t exact_mille = 0;
  for (std::int64_t i = 1; i <= 1000; ++i) {
    const std::int64_t rate = i % 2 == 0 ? 333 : 777;
    exact_mille += 1001 * (i % 2 == 0 ? 777 : 333);
    sut.set_rate(i * 1001, {rate});
  }
  EXPECT_NEAR(static_cast<double>(sut.recorded_at(1000 * 1001)),
              static_cast<double>(exact_mille) / 1000.0, 1000.0);
}

TEST(PlayClockTest, ASeekWorksWhilePausedAndWhileRunning) {
  PlayClock sut(kNow, kStart, {});
  sut.seek(kNow + 10, kStart + 5000);
  EXPECT_EQ(sut.due(kStart + 5000), kNow + 10);
  sut.pause(kNow + 20);
  sut.seek(kNow + 30, kStart);
  EXPECT_EQ(sut.recorded_at(kNow + 99), kStart);
  sut.resume(kNow + 100);
  EXPECT_EQ(sut.due(kStart + 1), kNow + 101);
}

}  // namespace
}  // namespace stillhand::recording::play_clock_test
