// SPDX-License-Identifier: Apache-2.0
#include "services/recording/core/loss_count.hpp"

#include <gtest/gtest.h>

namespace stillhand::recording {
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

}  // namespace
}  // namespace stillhand::recording
