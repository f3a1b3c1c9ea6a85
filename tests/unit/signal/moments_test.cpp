// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/moments.hpp"

#include <gtest/gtest.h>

namespace stillhand::signal::moments_test {
namespace {

TEST(MomentsTest, TheCorrelationIsThatOfTheDeviationsFromTheMeans) {
  const std::vector<double> x{1.0, 2.0, 3.0};
  // Deviations (-1, 0, 1) and (-1, 1, 0): 1 / sqrt(2 * 2).
  EXPECT_DOUBLE_EQ(correlation(x, std::vector{11.0, 13.0, 12.0}), 0.5);
  EXPECT_DOUBLE_EQ(correlation(x, std::vector{-2.0, -4.0, -6.0}), -1.0);
}

TEST(MomentsTest, AConstantSeriesCorrelatesWithNothing) {
  const std::vector<double> x{1.0, 2.0, 3.0};
  EXPECT_EQ(correlation(x, std::vector{7.0, 7.0, 7.0}), 0.0);
  EXPECT_EQ(correlation(std::vector{7.0, 7.0, 7.0}, x), 0.0);
}

}  // namespace
}  // namespace stillhand::signal::moments_test
