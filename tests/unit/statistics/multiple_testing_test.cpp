// SPDX-License-Identifier: Apache-2.0
#include "services/core/statistics/multiple_testing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iterator>

#include "services/core/contract/config_error.hpp"
#include "tests/support/statistics_golden.hpp"

namespace stillhand::statistics::multiple_testing_test {
namespace {

namespace golden = stillhand::golden::statistics;
using support::agrees;

const std::vector<double> kRaw(std::begin(golden::kRaw), std::end(golden::kRaw));

TEST(MultipleTestingTest, HolmEqualsR) {
  const auto sut = holm_adjusted(kRaw);
  ASSERT_EQ(sut.size(), std::size(golden::kHolm));
  for (std::size_t i = 0; i < sut.size(); ++i) EXPECT_TRUE(agrees(sut[i], golden::kHolm[i])) << i;
}

TEST(MultipleTestingTest, FollowsTheDefinitionByHand) {
  // 3 * 0.01; 2 * 0.02; the largest so far, since 1 * 0.03 is below it.
  EXPECT_THAT(holm_adjusted({0.03, 0.01, 0.02}),
              ::testing::Pointwise(::testing::DoubleEq(), {0.04, 0.03, 0.04}));
}

TEST(MultipleTestingTest, OneTestStaysAsItIsAndNoneStaysNone) {
  EXPECT_EQ(holm_adjusted({0.2}), (std::vector<double>{0.2}));
  EXPECT_TRUE(holm_adjusted({}).empty());
}

TEST(MultipleTestingTest, WhatIsNoProbabilityIsRefused) {
  for (const double outside : {-1e-9, 1.0 + 1e-9, std::nan("")}) {
    EXPECT_THROW(holm_adjusted({0.5, outside}), ConfigError);
  }
}

}  // namespace
}  // namespace stillhand::statistics::multiple_testing_test
