// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/core/request_rate.hpp"

#include <gtest/gtest.h>

namespace stillhand::dashboard::request_rate_test {

constexpr std::int64_t kMs = 1'000'000;
constexpr auto kMost = static_cast<int>(RequestRate::kMostPerSecond);

TEST(RequestRateTest, WhoAsksNowAndThenIsNeverHeldUp) {
  RequestRate sut;
  for (std::int64_t at_ms = 1; at_ms < 60'000; at_ms += 100) EXPECT_TRUE(sut.take(at_ms * kMs));
}

TEST(RequestRateTest, InNoSecondGoMoreThanSoManyOn) {
  RequestRate sut;
  int taken = 0;
  for (std::int64_t at_ms = 1; at_ms <= 5000; ++at_ms) taken += sut.take(at_ms * kMs) ? 1 : 0;
  EXPECT_EQ(taken, 5 * kMost);
  RequestRate burst;
  for (int i = 0; i < kMost; ++i) EXPECT_TRUE(burst.take(kMs));
  EXPECT_FALSE(burst.take(1000 * kMs));
  EXPECT_TRUE(burst.take(1001 * kMs));
}

}  // namespace stillhand::dashboard::request_rate_test
