// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/messages/release_errors.hpp"

#include <gtest/gtest.h>

namespace stillhand::recording::release_errors_test {
namespace {

TEST(ReleaseErrorsTest, PercentilesAreTheMicrosecondThatTheyStayBelow) {
  ReleaseErrors sut;
  EXPECT_EQ(sut.percentile_us(0.99), 0);
  EXPECT_EQ(sut.max_us(), 0);
  for (std::int64_t us = 0; us < 100; ++us) sut.add(us * 1000 + 500);
  EXPECT_EQ(sut.count(), 100u);
  EXPECT_EQ(sut.percentile_us(0.50), 50);
  EXPECT_EQ(sut.percentile_us(0.99), 99);
  EXPECT_EQ(sut.max_us(), 99);
}

TEST(ReleaseErrorsTest, WhatIsLaterThanATenthOfASecondStillShowsInTheMaximum) {
  ReleaseErrors sut;
  sut.add(5'000'000'000);
  EXPECT_EQ(sut.max_us(), 5'000'000);
  EXPECT_GT(sut.percentile_us(0.5), 100'000);
}

}  // namespace
}  // namespace stillhand::recording::release_errors_test
