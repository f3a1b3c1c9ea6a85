// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/loss_count.hpp"

#include <gtest/gtest.h>

#include <random>

namespace stillhand::recording::loss_count_test {
namespace {

TEST(LossCountTest, NothingIsLostWhereBothNumberingsGoOn) {
  LossCount sut;
  for (int i = 0; i < 10; ++i) sut.step(40 + i, 7 + i);
  EXPECT_EQ(sut.received(), 10);
  EXPECT_EQ(sut.lost(), 0);
}

TEST(LossCountTest, WhatWasSentBeforeTheFirstSampleIsNotLost) {
  LossCount sut;
  sut.step(1'000'000, 5'000'000);
  EXPECT_EQ(sut.lost(), 0);
}

TEST(LossCountTest, ASampleMissingByBothCountsOnce) {
  LossCount sut;
  sut.step(1, 10);
  sut.step(4, 13);
  EXPECT_EQ(sut.lost(), 2);
  EXPECT_EQ(sut.not_sent(), 0);
}

TEST(LossCountTest, TheEndOfAnInstanceIsNoLossAndHidesNone) {
  LossCount sut;
  sut.step(1, -1);
  sut.end_instance(2);
  sut.end_instance(3);
  sut.step(4, -1);
  EXPECT_EQ(sut.received(), 2);
  EXPECT_EQ(sut.lost(), 0);
  sut.end_instance(7);
  sut.step(8, -1);
  EXPECT_EQ(sut.lost(), 2);
}

TEST(LossCountTest, ATickThatNeverReachedTheWritersDdsIsLostTooAndToldApart) {
  LossCount sut;
  sut.step(1, 10);
  sut.step(2, 14);
  EXPECT_EQ(sut.lost(), 3);
  EXPECT_EQ(sut.not_sent(), 3);
}

TEST(LossCountTest, WithoutTicksTheSequenceAloneTells) {
  LossCount sut;
  sut.step(1, -1);
  sut.step(6, -1);
  EXPECT_EQ(sut.lost(), 4);
  EXPECT_EQ(sut.not_sent(), 0);
}

TEST(LossCountTest, AnotherSessionOfTheSameWriterIsNoLoss) {
  LossCount sut;
  sut.step(1, 9000);
  sut.step(2, 0);
  sut.step(3, 1);
  EXPECT_EQ(sut.lost(), 0);
}

// The writer drops ticks before DDS, the network drops sequence numbers: the count of each is
// known.
TEST(LossCountTest, OverRandomLossesTheCountsAreThoseThatWereMade) {
  std::mt19937_64 random(21);
  for (int round = 0; round < 200; ++round) {
    const auto network = random() % 4, writer = random() % 4;
    LossCount sut;
    std::int64_t sequence = static_cast<std::int64_t>(random() % 1000), received = 0, lost = 0,
                 not_sent = 0;
    std::int64_t lost_since = 0, not_sent_since = 0;  // losses at the end are not known yet
    for (Tick tick = 0; tick < 500; ++tick) {
      const bool reaches_dds = random() % 8 >= writer;
      if (!reaches_dds) {
        ++not_sent_since;
        continue;
      }
      ++sequence;
      if (random() % 8 < network) {
        ++lost_since;
        continue;
      }
      sut.step(sequence, tick);
      if (++received > 1) {
        lost += lost_since + not_sent_since;
        not_sent += not_sent_since;
      }
      lost_since = not_sent_since = 0;
    }
    ASSERT_EQ(sut.received(), received);
    ASSERT_EQ(sut.lost(), lost) << round;
    ASSERT_EQ(sut.not_sent(), not_sent) << round;
  }
}

}  // namespace
}  // namespace stillhand::recording::loss_count_test
