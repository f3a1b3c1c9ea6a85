// SPDX-License-Identifier: Apache-2.0
#include "services/system/process/cpu_share.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace stillhand::runtime::cpu_share_test {
namespace {

TEST(ShareMeterTest, TellsTheShareOfEachWholeSecond) {
  ShareMeter sut;
  EXPECT_TRUE(std::isnan(sut.step(500, 10'000, 1000)));
  EXPECT_TRUE(std::isnan(sut.step(600, 10'900, 1000)));  // not yet a second
  EXPECT_DOUBLE_EQ(sut.step(750, 11'000, 1000), 0.25);
  EXPECT_DOUBLE_EQ(sut.step(900, 11'500, 1000), 0.25);  // of the second before
  EXPECT_DOUBLE_EQ(sut.step(1750, 12'000, 1000), 1.0);
}

// The shares, each times its own span, add up to all that was used: nothing counts twice.
TEST(ShareMeterTest, TheSharesAddUpToAllThatWasUsed) {
  std::mt19937 random(20261123);
  ShareMeter sut;
  constexpr std::int64_t kLeast = 1000;
  std::int64_t used = 7, whole = std::int64_t{1} << 50;  // as after years
  sut.step(used, whole, kLeast);
  const std::int64_t used_before = used;
  std::int64_t last_whole = whole, counted_until = used;
  double sum = 0.0;
  for (int turn = 0; turn < 1000; ++turn) {
    const std::int64_t span = 1 + static_cast<std::int64_t>(random() % 700);
    whole += span;
    used += static_cast<std::int64_t>(random() % static_cast<std::uint32_t>(span + 1));
    const double share = sut.step(used, whole, kLeast);
    if (whole - last_whole < kLeast) continue;
    ASSERT_GE(share, 0.0);
    ASSERT_LE(share, 1.0);
    sum += share * static_cast<double>(whole - last_whole);
    last_whole = whole;
    counted_until = used;
  }
  // Up to 1000 roundings of sums below 2^19, each by half a unit in the last place of 2^19: 6e-8.
  EXPECT_NEAR(sum, static_cast<double>(counted_until - used_before), 1e-7);
}

// Busy until the meter tells of a whole second.
template <typename Meter>
double busy_share(Meter meter) {
  double share = meter.step();
  volatile double sink = 1.0;
  while (std::isnan(share)) {
    for (int i = 0; i < 10'000; ++i) sink = std::sqrt(sink + 1.0);
    share = meter.step();
  }
  return share;
}

TEST(ProcessCpuTest, ABusySecondCounts) {
  const double share = busy_share(ProcessCpu());
  EXPECT_GT(share, 0.0);
  EXPECT_LE(share, 1.1);
}

TEST(HostCpuTest, IsAShareOfTheWhole) {
  const double share = busy_share(HostCpu());
  EXPECT_GT(share, 0.0);
  EXPECT_LE(share, 1.0);
}

}  // namespace
}  // namespace stillhand::runtime::cpu_share_test
