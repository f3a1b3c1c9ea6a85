// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/log_bins.hpp"

#include <gtest/gtest.h>

namespace stillhand::signal::log_bins_test {
namespace {

TEST(LogBinsTest, EveryBinBeginsOneAfterTheEdgeOfTheBinBefore) {
  for (std::size_t bin = 1; bin < 8 * 24; ++bin) {
    const std::int64_t first = LogBins<3>::upper_edge(bin - 1) + 1;
    ASSERT_EQ(LogBins<3>::bin_of(first), bin);
    ASSERT_EQ(LogBins<3>::bin_of(LogBins<3>::upper_edge(bin)), bin);
  }
}

TEST(LogBinsTest, TheUpperEdgeIsAtMostOneBinWidthAboveTheValue) {
  for (std::int64_t value = 1; value < 1'000'000'000'000; value = value * 5 / 4 + 1) {
    const std::int64_t edge = LogBins<5>::upper_edge(LogBins<5>::bin_of(value));
    ASSERT_GE(edge, value);
    ASSERT_LE(32 * (edge - value), value) << value;
  }
}

TEST(LogBinsTest, ValuesBelowTheLinearBinsAreExact) {
  for (std::int64_t value = 0; value < 16; ++value) {
    EXPECT_EQ(LogBins<3>::upper_edge(LogBins<3>::bin_of(value)), value);
  }
}

}  // namespace
}  // namespace stillhand::signal::log_bins_test
