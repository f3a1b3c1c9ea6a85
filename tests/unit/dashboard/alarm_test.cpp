// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/core/alarm.hpp"

#include <gtest/gtest.h>

namespace stillhand::dashboard {
namespace {

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

}  // namespace
}  // namespace stillhand::dashboard
