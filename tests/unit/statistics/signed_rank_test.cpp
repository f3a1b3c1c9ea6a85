// SPDX-License-Identifier: Apache-2.0
#include "services/core/statistics/signed_rank.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/core/contract/config_error.hpp"
#include "tests/support/statistics_golden.hpp"

namespace stillhand::statistics::signed_rank_test {
namespace {

namespace golden = stillhand::golden::statistics;
using support::agrees;

TEST(SignedRankTest, ProbabilityEqualsR) {
  int most = 0;
  double smallest = 1.0;
  for (const auto& want : golden::kSignedRanks) {
    SCOPED_TRACE(std::to_string(want.count) + " differences, p = " + std::to_string(want.p));
    const double sut = signed_rank_p({want.differences, want.differences + want.count});
    EXPECT_TRUE(agrees(sut, want.p));
    most = std::max(most, want.count);
    smallest = std::min(smallest, sut);
  }
  EXPECT_GT(most, 25) << "the rows no longer test the normal approximation";
  EXPECT_LT(smallest, 1e-10) << "the rows no longer test the far tail";
}

// Three signs, eight ways: rank sums 0, 1, 2, 3, 3, 4, 5, 6.
TEST(SignedRankTest, FollowsTheDefinitionByHand) {
  EXPECT_DOUBLE_EQ(signed_rank_p({1.0, 2.0, 3.0}), 1.0 / 8.0);
  EXPECT_DOUBLE_EQ(signed_rank_p({-1.0, 2.0, 3.0}), 2.0 / 8.0);
  EXPECT_DOUBLE_EQ(signed_rank_p({1.0, 2.0, -3.0}), 5.0 / 8.0);
  EXPECT_DOUBLE_EQ(signed_rank_p({-1.0, -2.0, 3.0}), 5.0 / 8.0);
  EXPECT_DOUBLE_EQ(signed_rank_p({-1.0, -2.0, -3.0}), 1.0);
}

TEST(SignedRankTest, OrderCountsAndSizeDoesNot) {
  const double small = signed_rank_p({0.1, -0.2, 0.3, 0.4, 0.5, 0.6});
  EXPECT_EQ(small, signed_rank_p({0.4, 0.6, 1e9, -0.2, 0.1, 0.5}));
  EXPECT_NE(small, signed_rank_p({0.1, 0.2, 0.3, 0.4, 0.5, -0.6}));
}

// W >= w and W <= w together count W = w twice.
TEST(SignedRankTest, BothTailsTogetherAreOneAndTheMiddle) {
  const std::vector<double> up{1.0, -2.0, 3.0, -4.0, 5.0};
  std::vector<double> down = up;
  for (double& d : down) d = -d;
  // W = 9 (up), 6 (down) of 15; subsets of 1..5 with sum 9: {4,5} {1,3,5} {2,3,4}, so 3/32.
  EXPECT_DOUBLE_EQ(signed_rank_p(up) + signed_rank_p(down), 1.0 + 3.0 / 32.0);
}

// As scipy.stats.wilcoxon: seven subsets of the ranks 1 to 6 have a sum of 4 or less, 7/64 on
// either side.
TEST(SignedRankTest, TwoSidedItIsTwiceTheSmallerTailAndAtMostOne) {
  const std::vector<double> sut{1.0, 2.0, 3.0, -4.0, 5.0, 6.0};
  EXPECT_NEAR(signed_rank_two_sided_p(sut), 0.21875, 1e-15);
  std::vector<double> negated = sut;
  for (double& each : negated) each = -each;
  EXPECT_EQ(signed_rank_two_sided_p(negated), signed_rank_two_sided_p(sut));
  EXPECT_EQ(signed_rank_two_sided_p({1.0, -1.0}), 1.0);
  EXPECT_EQ(signed_rank_two_sided_p({0.0, 0.0}), 1.0);
}

TEST(SignedRankTest, ZerosAreLeftOutAndNothingLeftSaysNothing) {
  EXPECT_EQ(signed_rank_p({1.0, 0.0, 2.0, -0.0, 3.0}), signed_rank_p({1.0, 2.0, 3.0}));
  EXPECT_EQ(signed_rank_p({0.0, 0.0}), 1.0);
}

// With all signs positive p is exactly 2^-n.  At n = 26 the normal approximation has
// z = (351 - 175.5 - 0.5) / sqrt(26 27 53 / 24) = 4.445 and p = 4.40e-6: too large, on the safe
// side.
TEST(SignedRankTest, BeyondTwentyFiveTheTailIsApproximate) {
  std::vector<double> differences;
  for (int i = 1; i <= 25; ++i) differences.push_back(i);
  EXPECT_DOUBLE_EQ(signed_rank_p(differences), std::ldexp(1.0, -25));
  differences.push_back(26.0);
  EXPECT_NEAR(signed_rank_p(differences), 4.40e-6, 0.005e-6);
}

TEST(SignedRankTest, UnusableDifferencesAreRefused) {
  EXPECT_THROW(signed_rank_p({}), ConfigError);
  EXPECT_THROW(signed_rank_p({1.0, std::nan("")}), ConfigError);
  EXPECT_THROW(signed_rank_p({1.0, std::numeric_limits<double>::infinity()}), ConfigError);
}

}  // namespace
}  // namespace stillhand::statistics::signed_rank_test
