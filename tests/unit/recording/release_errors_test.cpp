// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/messages/release_errors.hpp"

#include <gtest/gtest.h>

namespace stillhand::recording {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

TEST(ReleaseErrorsTest, PercentilesAreTheMicrosecondThatTheyStayBelow) {
  ReleaseErrors sut;
  for (std::int64_t us = 0; us < 100; ++us) sut.add(us * 1000 + 500, 0);
  EXPECT_EQ(sut.count(), 100u);
  EXPECT_EQ(sut.percentile_us(0.50), 50);
  EXPECT_EQ(sut.percentile_us(0.99), 99);
  EXPECT_EQ(sut.max_us(), 99);
}

TEST(ReleaseErrorsTest, WhatIsLaterThanATenthOfASecondStillShowsInTheMaximum) {
  ReleaseErrors sut;
  sut.add(5 * kSecond, 0);
  EXPECT_EQ(sut.max_us(), 5'000'000);
  EXPECT_GT(sut.percentile_us(0.5), 100'000);
}

// An error that grows by 3 us a second; the line through exact points is exact.
TEST(ReleaseErrorsTest, DriftIsTheSlopeOverTheSeconds) {
  ReleaseErrors sut;
  for (std::int64_t second = 0; second < 60; ++second) {
    for (int i = 0; i < 10; ++i) sut.add((40 + 3 * second) * 1000, second * kSecond + i);
  }
  EXPECT_NEAR(sut.drift_us_s(), 3.0, 1e-9);
}

TEST(ReleaseErrorsTest, WithoutMessagesEverythingIsZero) {
  const ReleaseErrors sut;
  EXPECT_EQ(sut.percentile_us(0.99), 0);
  EXPECT_EQ(sut.max_us(), 0);
  EXPECT_EQ(sut.drift_us_s(), 0.0);
}

}  // namespace
}  // namespace stillhand::recording
