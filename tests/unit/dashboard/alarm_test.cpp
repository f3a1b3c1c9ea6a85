// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/core/alarm.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace stillhand::dashboard::alarm_test {

class AlarmTest : public ::testing::Test {
 protected:
  Alarm sut{Threshold{2.0, 5.0}};
};

TEST_F(AlarmTest, StaysUntilItIsAcknowledged) {
  sut.step(1.9, 1);
  EXPECT_EQ(sut.level(), Level::kHealthy);
  sut.step(2.0, 2);
  sut.step(3.0, 3);
  sut.step(0.0, 4);
  EXPECT_EQ(sut.level(), Level::kWarning);
  EXPECT_FALSE(sut.active());
  EXPECT_EQ(sut.since_ns(), 2);
  EXPECT_EQ(sut.last_ns(), 3);
  EXPECT_EQ(sut.worst(), 3.0);
  EXPECT_EQ(sut.count(), 1u);
  sut.acknowledge();
  EXPECT_EQ(sut.level(), Level::kHealthy);
}

TEST_F(AlarmTest, AcknowledgedWhileItLastsItGoesByItself) {
  sut.step(3.0, 1);
  sut.acknowledge();
  EXPECT_EQ(sut.level(), Level::kWarning);
  EXPECT_TRUE(sut.acknowledged());
  sut.step(1.0, 2);
  EXPECT_EQ(sut.level(), Level::kHealthy);
  sut.step(3.0, 3);
  EXPECT_FALSE(sut.acknowledged());  // another one
  EXPECT_EQ(sut.since_ns(), 3);
}

TEST_F(AlarmTest, WorseThanAcknowledgedWantsToBeSeenAgain) {
  sut.step(3.0, 1);
  sut.acknowledge();
  sut.step(5.0, 2);
  EXPECT_EQ(sut.level(), Level::kCritical);
  EXPECT_FALSE(sut.acknowledged());
}

TEST_F(AlarmTest, AcknowledgingTakesAPastCriticalBackToWhatIsNow) {
  sut.step(6.0, 1);
  sut.step(3.0, 2);
  EXPECT_EQ(sut.level(), Level::kCritical);
  sut.acknowledge();
  EXPECT_EQ(sut.level(), Level::kWarning);
  EXPECT_TRUE(sut.acknowledged());
}

TEST_F(AlarmTest, CountsHowOftenItWasRaised) {
  for (std::int64_t i = 0; i < 6; ++i) sut.step(i % 2 == 0 ? 3.0 : 0.0, i);
  EXPECT_EQ(sut.count(), 3u);
}

// Whatever the values: what is shown is never below the present value, nothing that nobody
// acknowledged goes away, and the worst value is that of the time since the alarm was raised.
TEST(AlarmInvariantTest, NothingUnacknowledgedGoesAwayOverRandomValues) {
  std::mt19937_64 random(31);
  const Threshold threshold{2.0, 5.0};
  for (int round = 0; round < 200; ++round) {
    Alarm sut(threshold);
    double worst = 0.0;
    for (std::int64_t now_ns = 1; now_ns < 300; ++now_ns) {
      const Level before = sut.level();
      if (random() % 10 == 0) {
        const bool active = sut.active();
        sut.acknowledge();
        ASSERT_EQ(sut.level() != Level::kHealthy, active);
        if (!active) worst = 0.0;
        continue;
      }
      const bool acknowledged = sut.acknowledged();
      const double value = static_cast<double>(random() % 700) / 100.0;
      sut.step(value, now_ns);
      ASSERT_GE(sut.level(), threshold.level_of(value));
      ASSERT_EQ(sut.active(), value >= threshold.warning);
      if (!acknowledged) {
        ASSERT_GE(sut.level(), before);
      }
      if (sut.level() == Level::kHealthy) {
        worst = 0.0;
        ASSERT_EQ(sut.count(), 0u);
        ASSERT_EQ(sut.since_ns(), 0);
      } else {
        if (sut.active()) worst = std::max(worst, value);
        ASSERT_EQ(sut.worst(), worst);
        ASSERT_GE(sut.count(), 1u);
        ASSERT_LE(sut.since_ns(), sut.last_ns());
        ASSERT_LE(sut.last_ns(), now_ns);
      }
    }
  }
}

TEST(AlarmInvariantTest, AValueThatIsNotANumberRaisesNothing) {
  Alarm sut(Threshold{2.0, 5.0});
  sut.step(std::nan(""), 1);
  EXPECT_EQ(sut.level(), Level::kHealthy);
  sut.step(3.0, 2);
  sut.step(std::nan(""), 3);
  EXPECT_EQ(sut.level(), Level::kWarning);
  EXPECT_EQ(sut.worst(), 3.0);
  EXPECT_FALSE(sut.active());
  sut.step(std::numeric_limits<double>::infinity(), 4);
  EXPECT_EQ(sut.level(), Level::kCritical);
}

TEST(AlarmInvariantTest, EqualThresholdsHaveNoWarning) {
  Alarm sut(Threshold{2.0, 2.0});
  sut.step(std::nextafter(2.0, 0.0), 1);
  EXPECT_EQ(sut.level(), Level::kHealthy);
  sut.step(2.0, 2);
  EXPECT_EQ(sut.level(), Level::kCritical);
}

}  // namespace stillhand::dashboard::alarm_test
