// SPDX-License-Identifier: Apache-2.0
// Fieller's interval of a ratio of means: Eq. ST-16.
#include "services/core/statistics/ratio.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "services/core/contract/config_error.hpp"
#include "services/core/statistics/descriptive.hpp"

namespace stillhand::statistics::ratio_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Eq. ST-21: four people have all three values, a fifth and a sixth do not.
TEST(RestoredShareTest, IsOfTheMeansOverThePeopleOfWhomAllThreeAreKnown) {
  const RestoredShare sut =
      restored_share({1.0, 2.0, 1.0, 2.0, 9.0, kNan}, {5.0, 6.5, 5.5, 6.0, 9.5, 3.0},
                     {3.0, 4.0, 3.0, 3.5, kNan, 2.0});
  EXPECT_DOUBLE_EQ(sut.share.value(), (2.0 + 2.5 + 2.5 + 2.5) / (4.0 + 4.5 + 4.5 + 4.0));
  ASSERT_TRUE(sut.interval);
  EXPECT_DOUBLE_EQ(sut.interval->ratio, *sut.share);
}

TEST(RestoredShareTest, WithoutALossOrAPersonThereIsNone) {
  EXPECT_FALSE(restored_share({1.0}, {1.0}, {0.0}).share);
  EXPECT_FALSE(restored_share({kNan}, {1.0}, {0.0}).share);
  EXPECT_FALSE(restored_share({1.0}, {2.0}, {1.5}).interval);
}

// With a denominator that does not vary, the interval is that of the numerator's mean over it.
TEST(RatioIntervalTest, IsTheMeansIntervalForAConstantDenominator) {
  const std::vector<double> x{1.0, 2.0, 4.0, 5.5};
  const MeanInterval mean = mean_interval(x);
  const auto sut = ratio_interval(x, {2.0, 2.0, 2.0, 2.0});
  ASSERT_TRUE(sut);
  EXPECT_NEAR(sut->ratio, mean.mean / 2.0, 1e-12);
  EXPECT_NEAR(sut->low, mean.low / 2.0, 1e-12);
  EXPECT_NEAR(sut->high, mean.high / 2.0, 1e-12);
}

// The bounds are the ratios r at which the paired t-test of x - r y has p = 0.05.
TEST(RatioIntervalTest, EndsWhereTheDifferenceIsJustSignificant) {
  // In thousandths: nothing depends on the unit.
  const std::vector<double> x{3.1e-3, 2.2e-3, 4.8e-3, 3.9e-3, 2.7e-3};
  const std::vector<double> y{5.0e-3, 4.1e-3, 6.2e-3, 6.6e-3, 4.4e-3};
  const auto sut = ratio_interval(x, y);
  ASSERT_TRUE(sut);
  EXPECT_LT(sut->low, sut->high);
  for (const double ratio : {sut->low, sut->high}) {
    std::vector<double> left;
    for (std::size_t i = 0; i < x.size(); ++i) left.push_back(x[i] - ratio * y[i]);
    const MeanInterval zero = mean_interval(left);
    EXPECT_NEAR(std::min(std::abs(zero.low), std::abs(zero.high)), 0.0, 1e-12);
  }
}

// 2000 samples of normal pairs whose true ratio is 0.5: 95 % hold it, give or take four times
// sqrt(0.95 0.05 / 2000) = 0.5 %.
TEST(RatioIntervalTest, HoldsTheTrueRatioAsOftenAsItSays) {
  std::mt19937 engine(3);
  std::normal_distribution<double> normal;
  int held = 0;
  for (int sample = 0; sample < 2000; ++sample) {
    std::vector<double> x;
    std::vector<double> y;
    for (int i = 0; i < 12; ++i) {
      const double common = normal(engine);
      x.push_back(5.0 + common + normal(engine));
      y.push_back(10.0 + common);
    }
    const auto interval = ratio_interval(x, y);
    if (interval && interval->low <= 0.5 && 0.5 <= interval->high) ++held;
  }
  EXPECT_NEAR(held / 2000.0, 0.95, 0.02);
}

TEST(RatioIntervalTest, HasNoBoundsForADenominatorThatMayBeZeroAndRefusesUnequalLengths) {
  EXPECT_FALSE(ratio_interval({1.0, 2.0, 3.0}, {-1.0, 0.5, 1.0}));
  EXPECT_THROW(ratio_interval({1.0, 2.0}, {1.0, 2.0, 3.0}), ConfigError);
}

}  // namespace
}  // namespace stillhand::statistics::ratio_test
