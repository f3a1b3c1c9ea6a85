// SPDX-License-Identifier: Apache-2.0
#include "services/core/contract/time_difference.hpp"

#include <gtest/gtest.h>

namespace stillhand::time_difference_test {
namespace {

TEST(TimeDifferenceTest, IsExactUpToThirtyYearsAndNoMoreBeyond) {
  constexpr std::int64_t kMost = 1'000'000'000'000'000'000;
  EXPECT_EQ(difference_ns(5, 7), -2);
  EXPECT_EQ(difference_ns(kMost, 0), kMost);
  EXPECT_EQ(difference_ns(kMost, -1), kMost);
  EXPECT_EQ(difference_ns(INT64_MAX, INT64_MIN), kMost);
  EXPECT_EQ(difference_ns(INT64_MIN, INT64_MAX), -kMost);
}

}  // namespace
}  // namespace stillhand::time_difference_test
