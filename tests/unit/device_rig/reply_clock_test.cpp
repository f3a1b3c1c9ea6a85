// SPDX-License-Identifier: Apache-2.0
#include "services/device_rig/core/reply_clock.hpp"

#include <gtest/gtest.h>

namespace stillhand::device_rig {
namespace {

using Verdict = ReplyClock::Verdict;

int wrapped(double ms) { return static_cast<std::int16_t>(static_cast<std::int64_t>(ms)); }

TEST(ReplyClockTest, RepliesInTimeAreYoungThroughEveryWrap) {
  ReplyClock sut;
  for (int ms = 0; ms < 200'000; ++ms) {
    EXPECT_EQ(sut.step(wrapped(ms), ms + 5000.0), Verdict::kYoung) << ms;
  }
}

// Two crystals differ by less than 0.01 %; the drive's clock may be trimmed by 0.25 % a step.
TEST(ReplyClockTest, AClockThatIsOnePercentFastStaysYoung) {
  ReplyClock sut;
  for (int ms = 0; ms < 100'000; ++ms) {
    EXPECT_EQ(sut.step(wrapped(1.01 * ms), ms), Verdict::kYoung) << ms;
  }
}

TEST(ReplyClockTest, TheSameReplyAgainAndAgainGrowsOldWithin21Ms) {
  ReplyClock sut;
  for (int ms = 0; ms < 1000; ++ms) sut.step(wrapped(ms), ms);
  int young = 0;
  for (int ms = 1000; ms < 3000; ++ms) {
    if (sut.step(wrapped(999), ms) == Verdict::kYoung) ++young;
  }
  // 20 ms and what the clocks forget meanwhile.
  EXPECT_LE(young, 21);
}

TEST(ReplyClockTest, RepliesThatAreHeldUpAreOldUntilTheyComeInTime) {
  ReplyClock sut;
  for (int ms = 0; ms < 1000; ++ms) sut.step(wrapped(ms), ms);
  for (int ms = 1050; ms < 1150; ++ms) EXPECT_EQ(sut.step(wrapped(ms - 50), ms), Verdict::kOld);
  EXPECT_EQ(sut.step(wrapped(1150), 1150), Verdict::kYoung);
}

// A drive that starts again must not get another torque: the first reply shows it.
TEST(ReplyClockTest, ACounterThatBeginsAgainIsANewStartAtOnce) {
  for (const int on_ms : {50, 5000, 30'000, 40'000, 65'000}) {
    ReplyClock sut;
    for (int ms = 0; ms < on_ms; ++ms) sut.step(wrapped(ms), ms);
    EXPECT_EQ(sut.step(wrapped(0), on_ms), Verdict::kRestarted) << on_ms;
    EXPECT_EQ(sut.step(wrapped(1), on_ms + 1), Verdict::kYoung) << on_ms;
  }
}

TEST(ReplyClockTest, ACounterThatStaysBehindIsANewStartInTheEnd) {
  ReplyClock sut;
  for (int ms = 0; ms < 5000; ++ms) sut.step(wrapped(ms), ms);
  int old = 0;
  while (sut.step(wrapped(5000 + old), 5050.0 + old) == Verdict::kOld) ++old;
  EXPECT_EQ(old, 200);
}

TEST(ReplyClockTest, AfterALongSilenceNothingIsKnown) {
  ReplyClock sut;
  sut.step(0, 0.0);
  EXPECT_EQ(sut.step(wrapped(40'000), 40'000.0), Verdict::kRestarted);
}

}  // namespace
}  // namespace stillhand::device_rig
