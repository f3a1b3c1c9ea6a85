// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/core/log_histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace stillhand::dashboard::log_histogram_test {

std::int64_t exact(std::vector<std::int64_t> values, double share) {
  std::ranges::sort(values);
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  return values[std::max<std::size_t>(rank, 1) - 1];
}

TEST(LogHistogramTest, QuantilesAreNeverTooLowAndAtMostOne32ndTooHigh) {
  std::mt19937_64 random(1);
  std::lognormal_distribution<double> latency(11.5, 2.0);  // about 100 us, over seven decades
  std::vector<std::int64_t> values;
  LogHistogram sut;
  for (int i = 0; i < 20'000; ++i) {
    values.push_back(static_cast<std::int64_t>(latency(random)));
    sut.add(values.back());
  }
  for (const double share : {0.001, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const std::int64_t want = exact(values, share);
    EXPECT_GE(sut.quantile_ns(share), want) << share;
    EXPECT_LE(sut.quantile_ns(share), want + want / 32) << share;
  }
  EXPECT_EQ(sut.max_ns(), *std::ranges::max_element(values));
  EXPECT_EQ(sut.quantile_ns(1.0), sut.max_ns());
}

TEST(LogHistogramTest, ValuesBelow64AreExact) {
  LogHistogram sut;
  for (std::int64_t value = 0; value < 64; ++value) sut.add(value);
  for (std::int64_t value = 0; value < 64; ++value) {
    EXPECT_EQ(sut.quantile_ns(static_cast<double>(value + 1) / 64.0), value);
  }
}

TEST(LogHistogramTest, NothingIsBeyondItsEnds) {
  LogHistogram sut;
  EXPECT_EQ(sut.spread(), Spread{});
  sut.add(-5);
  EXPECT_EQ(sut.negative(), 1u);
  EXPECT_EQ(sut.quantile_ns(1.0), 0);
  sut.add(INT64_MAX);
  EXPECT_EQ(sut.max_ns(), INT64_MAX);
  EXPECT_EQ(sut.quantile_ns(1.0), LogHistogram::kMost_ns);
  EXPECT_EQ(sut.count(), 2u);
}

TEST(LogHistogramTest, CountsUpToAnEdgeAddUpToAll) {
  LogHistogram sut;
  for (const std::int64_t ns : {10, 1'000, 50'000, 2'000'000}) sut.add(ns);
  EXPECT_EQ(sut.count_up_to(5), 0u);
  EXPECT_EQ(sut.count_up_to(2'000), 2u);
  EXPECT_EQ(sut.count_up_to(1'000'000), 3u);
  EXPECT_EQ(sut.count_up_to(LogHistogram::kMost_ns), 4u);
}

}  // namespace stillhand::dashboard::log_histogram_test
