// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/core/bus_health.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/refusal.hpp"

namespace stillhand::dashboard::bus_health_test {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kSecond = 1000 * kMs;
constexpr std::int64_t kBegin = 1000 * kSecond;

class BusHealthTest : public ::testing::Test {
 protected:
  BusHealthTest() { sut.set_running(true, kBegin); }
  // Sample `n` of a topic, `late_ns` after its time.
  void take(std::size_t topic, std::int64_t n, std::int64_t late_ns = 0) {
    const std::int64_t sent = kBegin + n * kMs + late_ns;
    sut.take(topic, {topic, n + 1, n, sent, sent, sent + kMs / 10});
  }
  // Both topics in step, and both processes alive, from one millisecond up to another.
  void run(std::int64_t from, std::int64_t to) {
    for (std::int64_t n = from; n < to; ++n) {
      take(0, n);
      take(1, n);
      if (n % 100 != 0) continue;
      sut.alive(0, kBegin + n * kMs);
      sut.alive(1, kBegin + n * kMs);
      sut.step(kBegin + n * kMs);
    }
  }
  const NamedAlarm& alarm(Watch watch, const std::string& subject) {
    for (const NamedAlarm& each : sut.alarms()) {
      if (each.watch == watch && each.subject == subject) return each;
    }
    throw std::out_of_range(subject);
  }

  BusHealth sut{Config{},
                {{"raw", kMs, 2 * kMs}, {"sensed", kMs, 2 * kMs}, {"event", 0, 0}},
                {"rig", "sensing"}};
};

TEST_F(BusHealthTest, AnUndisturbedSessionIsHealthy) {
  run(0, 5000);
  EXPECT_EQ(sut.level(), Level::kHealthy);
}

TEST_F(BusHealthTest, ALateSampleIsTheAlarmOfItsOwnTopic) {
  run(0, 3000);
  take(0, 3000);
  take(1, 3000, 20 * kMs);
  EXPECT_EQ(alarm(Watch::kLate, "sensed").alarm.level(), Level::kCritical);
  EXPECT_DOUBLE_EQ(alarm(Watch::kLate, "sensed").alarm.worst(), 19.0);  // 21 ms less 2 ms
  EXPECT_EQ(alarm(Watch::kLate, "raw").alarm.level(), Level::kHealthy);
  EXPECT_EQ(sut.level(), Level::kCritical);
  sut.acknowledge();
  take(1, 3001, 20 * kMs);
  EXPECT_EQ(sut.level(), Level::kHealthy);
}

TEST_F(BusHealthTest, StartUpIsPassedOver) {
  run(0, 1000);
  take(1, 1000, 20 * kMs);
  EXPECT_EQ(sut.level(), Level::kHealthy);  // the grace is 2 s
}

TEST_F(BusHealthTest, AStoppedProcessShowsByItsTopicAndItsName) {
  run(0, 3000);
  for (std::int64_t n = 3000; n < 4000; ++n) {
    take(0, n);
    if (n % 100 != 0) continue;
    sut.alive(0, kBegin + n * kMs);
    sut.step(kBegin + n * kMs);
  }
  EXPECT_EQ(alarm(Watch::kSilent, "sensed").alarm.level(), Level::kCritical);
  EXPECT_EQ(alarm(Watch::kService, "sensing").alarm.level(), Level::kWarning);
  EXPECT_EQ(alarm(Watch::kSilent, "raw").alarm.level(), Level::kHealthy);
  EXPECT_EQ(alarm(Watch::kService, "rig").alarm.level(), Level::kHealthy);
}

TEST_F(BusHealthTest, AProcessThatNeverCameIsMissing) {
  for (std::int64_t n = 0; n <= 5000; n += 100) {
    sut.alive(0, kBegin + n * kMs);
    sut.step(kBegin + n * kMs);
  }
  EXPECT_EQ(alarm(Watch::kService, "sensing").alarm.level(), Level::kCritical);
}

TEST_F(BusHealthTest, TheEndOfASessionIsNoFault) {
  run(0, 3000);
  sut.set_running(false, kBegin + 3 * kSecond);
  sut.step(kBegin + 60 * kSecond);
  EXPECT_EQ(sut.level(), Level::kHealthy);
}

TEST_F(BusHealthTest, WhatWasLateWhenTheSessionEndedStaysAndCanBeAcknowledged) {
  run(0, 3000);
  take(1, 3000, 20 * kMs);
  sut.set_running(false, kBegin + 4 * kSecond);
  sut.step(kBegin + 5 * kSecond);
  EXPECT_EQ(sut.level(), Level::kCritical);
  sut.acknowledge();
  EXPECT_EQ(sut.level(), Level::kHealthy);
}

TEST_F(BusHealthTest, ALongChainIsTold) {
  run(0, 3000);
  sut.chain().command(3000, kSecond, kSecond + kMs);
  sut.chain().used(3000, kSecond + 12 * kMs);
  sut.step(kBegin + 3000 * kMs);
  EXPECT_EQ(alarm(Watch::kChain, "").alarm.level(), Level::kCritical);
}

TEST_F(BusHealthTest, ASecondWriterOfATopicTakesNoAlarmAway) {
  const auto second = [&](std::int64_t n) {
    const std::int64_t sent = kBegin + n * kMs;
    sut.take(1, {7, n + 1, n, sent, sent, sent + kMs / 10});
  };
  for (std::int64_t n = 0; n < 5000; ++n) {
    take(0, n);
    take(1, n);
    if (n % 1000 != 999) second(n);
  }
  EXPECT_EQ(alarm(Watch::kLost, "sensed").alarm.level(), Level::kWarning);
}

TEST_F(BusHealthTest, TimesThatCannotBeRaiseNothing) {
  constexpr std::int64_t kFar = 9'000'000'000'000'000'000;  // of a damaged file
  BusHealth fresh{Config{}, {{"raw", kMs, 2 * kMs}}, {"rig", "sensing"}};
  fresh.set_running(true, kFar);
  fresh.step(-kFar);
  EXPECT_EQ(fresh.level(), Level::kHealthy);
}

TEST(BusHealthConfigTest, AWarningAboveItsCriticalValueIsRefused) {
  const Config config{.silent_warning_ms = 400.0};
  EXPECT_THAT(support::refusal([&] { BusHealth(config, {}, {}); }),
              testing::StrEq("dashboard.silent_warning_ms: got 400, want at most 300, the "
                             "critical value"));
}

}  // namespace stillhand::dashboard::bus_health_test
