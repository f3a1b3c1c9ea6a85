// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/cycle_monitor.hpp"

#include <gtest/gtest.h>

namespace stillhand::signal::cycle_monitor_test {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TEST(CycleMonitorTest, FindsNothingInAPunctualStream) {
  CycleMonitor sut;
  for (Tick n = 0; n < 1000; ++n) {
    const auto verdict = sut.step(n, n * kMs, n * kMs + 90'000);
    ASSERT_EQ(verdict.lost, 0);
    ASSERT_EQ(verdict.late_by_us, 0);
  }
  EXPECT_EQ(sut.misses(), 0);
  EXPECT_EQ(sut.worst_interval_us(), 1000);
}

TEST(CycleMonitorTest, TellsByHowManyMicrosecondsASampleIsLate) {
  CycleMonitor sut({1000, 500});
  sut.step(0, 0, 0);
  // Due at 1000 us, tolerated to 1500 us, arrived at 1749 us.
  EXPECT_EQ(sut.step(1, kMs, 1'749'000).late_by_us, 249);
  EXPECT_EQ(sut.misses(), 1);
  // By default a period of 1 ms, and one further period that the reader absorbs.
  CycleMonitor usual;
  usual.step(0, 0, 0);
  usual.step(1, kMs, 2 * kMs);
  EXPECT_EQ(usual.misses(), 0);
  EXPECT_EQ(usual.step(2, 2 * kMs, 4 * kMs + 1000).late_by_us, 1);
}

TEST(CycleMonitorTest, CountsEachLostTickAndIgnoresOneThatIsNotNewer) {
  CycleMonitor sut;
  sut.step(10, 0, 0);
  EXPECT_EQ(sut.step(10, 0, kMs).lost, 0);
  EXPECT_EQ(sut.step(9, 0, kMs).lost, 0);
  EXPECT_EQ(sut.step(11, 0, 2 * kMs).lost, 0);
  EXPECT_EQ(sut.lost(), 0);
  EXPECT_EQ(sut.worst_interval_us(), 2000) << "from the first sample of tick 10";
  EXPECT_EQ(sut.step(15, 0, 4 * kMs).lost, 3);
  EXPECT_EQ(sut.lost(), 3);
}

TEST(CycleMonitorTest, LatencyPercentilesAreWithinABinOfTheTruth) {
  CycleMonitor sut;
  // Latencies 1 .. 10000 us, once each: the p share is p * 10000 us; bins are at most 12.5 % wide.
  for (Tick n = 0; n < 10'000; ++n) sut.step(n, n * kMs, n * kMs + (n + 1) * 1000);
  for (const double share : {0.1, 0.5, 0.9, 0.99}) {
    const auto truth = share * 10'000.0;
    EXPECT_GE(static_cast<double>(sut.latency_us(share)), truth * 0.999) << share;
    EXPECT_LE(static_cast<double>(sut.latency_us(share)), truth * 1.126) << share;
  }
  EXPECT_EQ(sut.max_latency_us(), 10'000);
  // Below 16 us a bin holds one value: of 0 .. 15 us once each, n are shorter than n us.
  CycleMonitor fast;
  for (Tick n = 0; n < 16; ++n) fast.step(n, n * kMs, n * kMs + n * 1000);
  for (int n = 0; n < 16; ++n) EXPECT_EQ(fast.latency_us(n / 16.0), n);
}

TEST(CycleMonitorTest, TakesAnyLatencyWithoutLeavingItsBins) {
  CycleMonitor sut;
  sut.step(0, 0, -5 * kMs);  // clocks of two hosts
  sut.step(1, 0, INT64_MAX / 2);
  EXPECT_EQ(sut.samples(), 2);
  EXPECT_EQ(sut.latency_us(0.0), 0);
  EXPECT_EQ(sut.latency_us(0.99), (1 << 26) - 1) << "192 bins, 8 an octave, end at 2^26 us";
}

}  // namespace
}  // namespace stillhand::signal::cycle_monitor_test
