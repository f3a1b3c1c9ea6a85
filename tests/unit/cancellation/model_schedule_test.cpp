// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/model_schedule.hpp"

#include <gtest/gtest.h>

namespace stillhand::cancellation::model_schedule_test {
namespace {

void expect_taken(const ModelSchedule::Due& due, Tick late_ticks = 0) {
  EXPECT_TRUE(due.take);
  EXPECT_EQ(due.late_ticks, late_ticks);
}

TEST(ModelScheduleTest, AModelIsTakenAtItsFirstTickAndOnce) {
  ModelSchedule sut;
  EXPECT_FALSE(sut.step(0).take);
  sut.offer(0, 250);
  EXPECT_EQ(sut.waits_for(), 250);
  for (Tick tick = 1; tick < 250; ++tick) ASSERT_FALSE(sut.step(tick).take) << tick;
  EXPECT_EQ(sut.in_use(), -1);
  expect_taken(sut.step(250));
  EXPECT_EQ(sut.in_use(), 0);
  EXPECT_EQ(sut.waits_for(), std::nullopt);
  for (Tick tick = 251; tick < 600; ++tick) ASSERT_FALSE(sut.step(tick).take) << tick;
}

TEST(ModelScheduleTest, ALostTickTakesTheModelWithTheNextSampleAndIsNotLate) {
  ModelSchedule sut;
  sut.step(0);
  sut.offer(3, 10);
  EXPECT_FALSE(sut.step(9).take);
  expect_taken(sut.step(13));
  sut.step(29);
  sut.offer(4, 30);  // in time still
  expect_taken(sut.step(30));
}

TEST(ModelScheduleTest, AModelThatIsReadyTooLateIsTakenAtOnceAndCounted) {
  ModelSchedule sut;
  for (Tick tick = 0; tick <= 12; ++tick) sut.step(tick);
  sut.offer(1, 10);  // ticks 10, 11 and 12 were answered without it
  expect_taken(sut.step(13), 3);
  EXPECT_EQ(sut.in_use(), 1);
}

// A replay that begins behind the model's first tick publishes the model first.
TEST(ModelScheduleTest, LatenessCountsFromTheFirstSample) {
  ModelSchedule in_time;
  in_time.offer(0, 10);
  EXPECT_EQ(in_time.step(5000).late_ticks, 0);
  EXPECT_EQ(in_time.in_use(), 0);
  ModelSchedule late;
  late.step(5000);
  late.step(5001);
  late.offer(0, 10);
  EXPECT_EQ(late.step(5002).late_ticks, 2);
}

TEST(ModelScheduleTest, ANewerModelReplacesOneThatWaits) {
  ModelSchedule sut;
  sut.offer(0, 10);
  sut.offer(1, 20);
  EXPECT_EQ(sut.waits_for(), 20);
  EXPECT_FALSE(sut.step(10).take);
  EXPECT_TRUE(sut.step(20).take);
  EXPECT_EQ(sut.in_use(), 1);
}

TEST(ModelScheduleTest, AClockThatBeginsAgainMakesTheModelWaitAgain) {
  ModelSchedule sut;
  sut.step(900);
  sut.offer(0, 1000);
  EXPECT_FALSE(sut.step(0).take);
  EXPECT_FALSE(sut.step(999).take);
  expect_taken(sut.step(1000));
}

}  // namespace
}  // namespace stillhand::cancellation::model_schedule_test
