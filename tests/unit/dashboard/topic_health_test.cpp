// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/core/topic_health.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>

namespace stillhand::dashboard::topic_health_test {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kSecond = 1000 * kMs;
constexpr std::int64_t kBegin = 1000 * kSecond;  // of the listener's clock
const TopicPlan kStream{"stillhand/sensed", kMs, 2 * kMs};

// Sample `n` of a writer in step: sent at n ms, 100 us on the way.
Sample on_time(std::int64_t n) {
  const std::int64_t sent = kBegin + n * kMs;
  return {1, n + 1, n, 7 + n * kMs, sent, sent + kMs / 10};
}

TEST(TopicHealthTest, AWriterInStepHasItsRateNoJitterAndOneLatency) {
  TopicHealth sut(kStream);
  for (std::int64_t n = 0; n < 2500; ++n) sut.step(on_time(n));
  const TopicReport report = sut.report(kBegin + 2500 * kMs);
  EXPECT_EQ(report.samples, 2500u);
  EXPECT_EQ(report.rate_hz, 1000.0);
  EXPECT_EQ(report.jitter.count, 2499u);
  EXPECT_EQ(report.jitter.max_ns, 0);
  EXPECT_EQ(report.latency, (Spread{2500, kMs / 10, kMs / 10, kMs / 10, kMs / 10}));
  EXPECT_EQ(report.lost, 0u);
  EXPECT_EQ(report.sent.count + report.arrived.count, 0u);
  EXPECT_EQ(report.first_tick, 0);
  EXPECT_EQ(report.last_tick, 2499);
}

TEST(TopicHealthTest, ASilentTopicHasNoRate) {
  TopicHealth sut(kStream);
  for (std::int64_t n = 0; n < 1500; ++n) sut.step(on_time(n));
  EXPECT_EQ(sut.report(kBegin + 1600 * kMs).rate_hz, 1000.0);
  EXPECT_EQ(sut.report(kBegin + 2 * kSecond).rate_hz, 500.0);
  EXPECT_EQ(sut.report(kBegin + 3 * kSecond).rate_hz, 0.0);
  EXPECT_EQ(sut.report(kBegin + 3 * kSecond).recent_latency, Spread{});
}

TEST(TopicHealthTest, ALateWriterIsToldToTheMicrosecondWithSinceWhen) {
  TopicHealth sut(kStream);
  for (std::int64_t n = 0; n < 10; ++n) sut.step(on_time(n));
  Sample late = on_time(10);
  const std::int64_t by = 1'500'000 - 1;  // interval 1 + 1.499999 ms: in time by half a millisecond
  late.stamp_ns += kMs;
  late.source_ns += kMs;
  late.arrived_ns += kMs;
  EXPECT_EQ(sut.step(late).sent_late_ns, 0);  // exactly the deadline
  Sample later = on_time(14);                 // 3 ms after its due time, no tick is missing
  later.tick = 11;
  later.sequence = 12;
  later.stamp_ns = late.stamp_ns + 2 * kMs + by;
  later.source_ns = late.source_ns + 2 * kMs + by;
  later.arrived_ns = late.arrived_ns + 2 * kMs + by;
  const Verdict verdict = sut.step(later);
  EXPECT_EQ(verdict.sent_late_ns, by);
  EXPECT_EQ(verdict.arrived_late_ns, by);
  const TopicReport report = sut.report(later.arrived_ns);
  EXPECT_EQ(report.sent.count, 1u);
  EXPECT_EQ(report.sent.worst_ns, by);
  EXPECT_EQ(report.sent.first_at_ns, later.arrived_ns);
}

TEST(TopicHealthTest, HeldUpOnTheWayIsNotTheWritersLateness) {
  TopicHealth sut(kStream);
  sut.step(on_time(0));
  Sample held = on_time(1);
  held.arrived_ns += 5 * kMs;
  const Verdict verdict = sut.step(held);
  EXPECT_EQ(verdict.sent_late_ns, 0);
  EXPECT_EQ(verdict.arrived_late_ns, 4 * kMs);
}

TEST(TopicHealthTest, ALostSampleIsAGapAndNoLateness) {
  TopicHealth sut(kStream);
  sut.step(on_time(0));
  EXPECT_EQ(sut.step(on_time(4)).lost, 3);
  Sample skipped = on_time(6);  // the writer made tick 5 and never sent it
  skipped.sequence = 6;
  EXPECT_EQ(sut.step(skipped).lost, 1);
  const TopicReport report = sut.report(kBegin + 7 * kMs);
  EXPECT_EQ(report.lost, 4u);
  EXPECT_EQ(report.not_sent, 1u);
  EXPECT_EQ(report.lost_since_ns, on_time(4).arrived_ns);
  EXPECT_EQ(report.sent.count + report.arrived.count, 0u);
  EXPECT_EQ(report.jitter.max_ns, 0);
}

TEST(TopicHealthTest, AClockThatIsAheadIsTakenOffTheLatency) {
  TopicHealth sut(kStream);
  Sample sample = on_time(0);
  sample.source_ns += 3 * kSecond;
  sut.step(sample, 3 * kSecond);
  EXPECT_EQ(sut.report(kBegin).latency.max_ns, kMs / 10);
  EXPECT_EQ(sut.report(kBegin).negative_latencies, 0u);
}

TEST(TopicHealthTest, AnotherWriterOfAStreamIsAnotherSession) {
  TopicHealth sut(kStream);
  for (std::int64_t n = 0; n < 10; ++n) sut.step(on_time(n));
  Sample fresh = on_time(60'000);
  fresh.writer = 2;
  fresh.tick = 0;
  EXPECT_EQ(sut.step(fresh).lost, 0);
  EXPECT_EQ(sut.report(fresh.arrived_ns).samples, 1u);
}

TEST(TopicHealthTest, OfTwoThatWriteAtTheSameTimeTheOneFoundLaterCounts) {
  TopicHealth sut(kStream);
  for (std::int64_t n = 0; n < 10; ++n) sut.step(on_time(n));
  for (std::int64_t n = 10; n < 100; ++n) {
    Sample later = on_time(n);
    later.writer = 2;
    if (n % 10 != 9) {
      EXPECT_TRUE(sut.step(later).counted) << n;
    }
    EXPECT_FALSE(sut.step(on_time(n)).counted) << n;
  }
  EXPECT_EQ(sut.report(kBegin + 100 * kMs).samples, 81u);
  EXPECT_EQ(sut.report(kBegin + 100 * kMs).lost, 8u);  // nobody knows of the last yet
}

TEST(TopicHealthTest, WhoWroteBeforeCountsAgainOnceTheOtherIsSilent) {
  TopicHealth sut(kStream);
  sut.step(on_time(0));
  Sample later = on_time(1);
  later.writer = 2;
  sut.step(later);
  EXPECT_FALSE(sut.step(on_time(1000)).counted);
  EXPECT_TRUE(sut.step(on_time(1001)).counted);
  EXPECT_EQ(sut.report(kBegin + 1001 * kMs).samples, 1u);
}

TEST(TopicHealthTest, WritersOfOneTopicAreCountedApartAndAddedUp) {
  TopicHealth sut({"stillhand/service_status", 100 * kMs, 0});
  for (std::int64_t n = 0; n < 20; ++n) {
    for (std::size_t writer = 0; writer < 9; ++writer) {
      const std::int64_t sent = kBegin + n * 100 * kMs + static_cast<std::int64_t>(writer) * kMs;
      sut.step({writer, n + 1, -1, 0, sent, sent});
    }
  }
  const TopicReport report = sut.report(kBegin + 2 * kSecond);
  EXPECT_EQ(report.samples, 180u);
  EXPECT_EQ(report.rate_hz, 90.0);
  EXPECT_EQ(report.jitter.max_ns, 0);
  EXPECT_EQ(report.lost, 0u);
}

TEST(TopicHealthTest, WritersWithoutEndAreNoMemoryWithoutEnd) {
  TopicHealth sut({"stillhand/event", 0, 0});
  for (std::size_t writer = 0; writer < 10'000; ++writer) {
    const std::int64_t at = kBegin + static_cast<std::int64_t>(writer);
    EXPECT_EQ(sut.step({writer, 1, -1, 0, at, at}).lost, 0);
  }
  EXPECT_EQ(sut.report(kBegin + kSecond).samples, 10'000u);
}

// Reference: sums over the list of samples itself.
TEST(TopicHealthTest, OverRandomLossesItsReportIsWhatTheSamplesAddUpTo) {
  std::mt19937_64 random(51);
  constexpr std::int64_t kPeriod_ns = 1'000'000, kDeadline_ns = 2'000'000;
  for (int round = 0; round < 20; ++round) {
    TopicHealth sut({"sensed", kPeriod_ns, kDeadline_ns});
    std::uint64_t samples = 0, lost = 0, late = 0;
    std::int64_t worst_ns = 0, before_ns = 0, first_gap_ns = 0;
    Tick before = -1;
    for (Tick tick = 0; tick < 2500; ++tick) {
      if (tick > 0 && random() % 20 == 0) continue;  // lost on the way
      const std::int64_t delay_ns =
          random() % 50 == 0 ? static_cast<std::int64_t>(random() % 5'000'000) : 0;
      const std::int64_t sent_ns = 5'000'000'000 + tick * kPeriod_ns + delay_ns;
      const Verdict verdict = sut.step({0, tick + 1, tick, sent_ns, sent_ns, sent_ns + 70'000});
      const std::int64_t gap = samples == 0 ? 0 : tick - before - 1;
      ASSERT_EQ(verdict.lost, gap);
      if (gap > 0 && lost == 0) first_gap_ns = sent_ns + 70'000;
      lost += static_cast<std::uint64_t>(gap);
      const std::int64_t by_ns =
          samples == 0 ? 0 : sent_ns - before_ns - gap * kPeriod_ns - kDeadline_ns;
      ASSERT_EQ(verdict.sent_late_ns, std::max<std::int64_t>(by_ns, 0));
      ASSERT_EQ(verdict.arrived_late_ns, verdict.sent_late_ns) << "the way takes 70 us each time";
      if (by_ns > 0) ++late;
      worst_ns = std::max(worst_ns, by_ns);
      ++samples;
      before = tick;
      before_ns = sent_ns;
    }
    const TopicReport report = sut.report(5'000'000'000);
    ASSERT_EQ(report.samples, samples);
    ASSERT_EQ(report.lost, lost);
    ASSERT_EQ(report.lost_since_ns, first_gap_ns);
    ASSERT_EQ(report.sent.count, late);
    ASSERT_EQ(report.sent.worst_ns, worst_ns);
    ASSERT_EQ(report.first_tick, 0);
    ASSERT_EQ(report.last_tick, before);
    ASSERT_EQ(report.latency.count, samples);
    ASSERT_EQ(report.latency.max_ns, 70'000);
    ASSERT_EQ(report.jitter.count, samples - 1);
  }
}

// Times and ticks come from the bus or a file: they can be anything.
TEST(TopicHealthTest, ExtremeTimesAndTicksNeitherOverflowNorGiveNegativeLateness) {
  const std::array<std::int64_t, 7> extremes{INT64_MIN, INT64_MIN + 1, -1,       0,
                                             1,         INT64_MAX - 1, INT64_MAX};
  std::mt19937_64 random(52);
  const auto any = [&] { return extremes[random() % extremes.size()]; };
  TopicHealth sut({"sensed", 1'000'000, 2'000'000});
  for (int i = 0; i < 1000; ++i) {
    const Tick tick = std::max<Tick>(any(), -1);
    const Verdict verdict = sut.step(
        {random() % 3, static_cast<std::int64_t>(random() % 1000), tick, any(), any(), any()});
    ASSERT_GE(verdict.sent_late_ns, 0);
    ASSERT_GE(verdict.arrived_late_ns, 0);
    ASSERT_GE(verdict.lost, 0);
    (void)sut.report(any());
    ASSERT_GE(sut.recent_latency_p99_ns(any()), 0);
  }
}

}  // namespace stillhand::dashboard::topic_health_test
