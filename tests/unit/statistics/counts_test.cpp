// SPDX-License-Identifier: Apache-2.0
// Intervals of a share and of a median: Eqs. ST-19 and ST-20.
#include "services/core/statistics/counts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "services/core/contract/config_error.hpp"

namespace stillhand::statistics::counts_test {
namespace {

// For none of n the upper end is 1 - 0.025^(1/n), by hand.
TEST(ShareIntervalTest, IsThatOfClopperAndPearson) {
  const ShareInterval none = share_interval(0, 48);
  EXPECT_EQ(none.low, 0.0);
  EXPECT_NEAR(none.high, 1.0 - std::pow(0.025, 1.0 / 48.0), 1e-12);
  const ShareInterval all = share_interval(48, 48);
  EXPECT_EQ(all.high, 1.0);
  EXPECT_NEAR(all.low, std::pow(0.025, 1.0 / 48.0), 1e-12);
}

// The ends are the shares at which so many, or so few, have a chance of 2.5 %: the definition,
// summed by hand.
TEST(ShareIntervalTest, EndsWhereTheTailsAreSmall) {
  const auto chance_of = [](int k, int n, double p) {
    return std::exp(std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) +
                    k * std::log(p) + (n - k) * std::log1p(-p));
  };
  const ShareInterval sut = share_interval(5, 48);
  double as_many = 0.0;
  for (int k = 5; k <= 48; ++k) as_many += chance_of(k, 48, sut.low);
  double as_few = 0.0;
  for (int k = 0; k <= 5; ++k) as_few += chance_of(k, 48, sut.high);
  EXPECT_NEAR(as_many, 0.025, 1e-9);
  EXPECT_NEAR(as_few, 0.025, 1e-9);
  EXPECT_DOUBLE_EQ(sut.share, 5.0 / 48.0);
}

// Ten values: the second and the ninth (chance of one or none below: 11/1024).
TEST(MedianIntervalTest, LiesBetweenTwoOfTheValues) {
  const MedianInterval sut = median_interval({10, 1, 9, 2, 8, 3, 7, 4, 6, 5});
  EXPECT_DOUBLE_EQ(sut.median, 5.5);
  EXPECT_DOUBLE_EQ(sut.low, 2.0);
  EXPECT_DOUBLE_EQ(sut.high, 9.0);
  const MedianInterval none = median_interval({1, 2, 3, 4, 5});  // 1/32 is too much
  EXPECT_TRUE(std::isinf(none.low) && std::isinf(none.high));
}

// Of 4000 samples of 15 the interval holds the true median in 95 % or more: 0.965 by the binomial,
// standard error 0.003.
TEST(MedianIntervalTest, HoldsTheMedianAsOftenAsItSays) {
  std::mt19937_64 engine(3);
  std::lognormal_distribution<double> draw;
  int held = 0;
  for (int i = 0; i < 4000; ++i) {
    std::vector<double> values(15);
    std::ranges::generate(values, [&] { return draw(engine); });
    const MedianInterval one = median_interval(values);
    held += one.low <= 1.0 && 1.0 <= one.high ? 1 : 0;
  }
  EXPECT_NEAR(held / 4000.0, 0.965, 0.012);
}

TEST(CountsTest, RefusesWhatIsNoCount) {
  EXPECT_THROW(share_interval(1, 0), ConfigError);
  EXPECT_THROW(share_interval(3, 2), ConfigError);
  EXPECT_THROW(share_interval(1, 2, 1.0), ConfigError);
  EXPECT_THROW(share_interval(1, 2, 0.0), ConfigError);
  EXPECT_THROW(median_interval({}), ConfigError);
}

}  // namespace
}  // namespace stillhand::statistics::counts_test
