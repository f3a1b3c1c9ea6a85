// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/core/chain_health.hpp"

#include <gtest/gtest.h>

namespace stillhand::dashboard::chain_health_test {

constexpr std::int64_t kUs = 1000;

TEST(ChainHealthTest, FirstUseOfAnAnswerEndsItsChain) {
  ChainHealth sut;
  sut.sensed(1000 * kUs, 1100 * kUs);
  sut.command(5, 1000 * kUs, 1250 * kUs);
  sut.used(5, 2000 * kUs);
  sut.used(5, 3000 * kUs);  // still in use a tick later: no other latency
  EXPECT_EQ(sut.to_sensed().max_ns, 100 * kUs);
  EXPECT_EQ(sut.to_command().max_ns, 250 * kUs);
  EXPECT_EQ(sut.to_motor().count, 1u);
  EXPECT_EQ(sut.to_motor().max_ns, 1000 * kUs);
}

TEST(ChainHealthTest, TheOrderInWhichTopicsArriveDoesNotMatter) {
  ChainHealth one, other;
  for (Tick tick = 0; tick < 3000; ++tick) {
    const std::int64_t acquired = (tick + 1) * 1000 * kUs;
    const std::int64_t used = acquired + (1000 + tick % 7) * kUs;
    one.command(tick, acquired, acquired + 300 * kUs);
    one.used(tick, used);
    other.used(tick, used);
    other.command(tick, acquired, acquired + 300 * kUs);
  }
  EXPECT_EQ(one.to_motor().count, 3000u);
  EXPECT_EQ(one.to_motor(), other.to_motor());
  EXPECT_EQ(one.to_command(), other.to_command());
}

TEST(ChainHealthTest, AnAnswerThatWasNeverUsedOrNeverHeardIsNoLatency) {
  ChainHealth sut;
  sut.used(-1, 500 * kUs);
  sut.command(1, 1000 * kUs, 1200 * kUs);  // the next one overtook it
  sut.used(2, 3000 * kUs);                 // its command was lost on the way here
  EXPECT_EQ(sut.to_motor().count, 0u);
  sut.command(1026, 2'000'000 * kUs, 2'000'200 * kUs);  // the same place in the ring as tick 2
  EXPECT_EQ(sut.to_motor().count, 0u);
}

TEST(ChainHealthTest, TheWorstIsOfTheTimeSinceItWasAsked) {
  ChainHealth sut;
  sut.command(1, 1000 * kUs, 1200 * kUs);
  sut.used(1, 9000 * kUs);
  EXPECT_EQ(sut.take_worst_ns(), 8000 * kUs);
  EXPECT_EQ(sut.take_worst_ns(), 0);
}

}  // namespace stillhand::dashboard::chain_health_test
