// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/newest_of_each.hpp"

#include <gtest/gtest.h>

namespace stillhand::signal::newest_of_each_test {
namespace {

TEST(NewestOfEachTest, ARequestCountsOnceWhateverOthersAskBetween) {
  NewestOfEach<char> sut;
  EXPECT_TRUE(sut.take('A', 10));
  EXPECT_TRUE(sut.take('B', 20));
  EXPECT_FALSE(sut.take('A', 10));
  EXPECT_FALSE(sut.take('B', 19));
  EXPECT_TRUE(sut.take('A', 11));
}

TEST(NewestOfEachTest, StrangersDoNotMakeItForgetWhoStillAsks) {
  NewestOfEach<int> sut;
  for (int stranger = 1; stranger < 1000; ++stranger) {
    EXPECT_EQ(sut.take(0, 5), stranger == 1);
    EXPECT_TRUE(sut.take(stranger, 1));
  }
}

}  // namespace
}  // namespace stillhand::signal::newest_of_each_test
