// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/page/binning.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "services/core/signal/random.hpp"

namespace stillhand::diagnose::binning_test {

struct Cloud {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> weight;
};

// y = x + noise of deviation 0.3 over x from 0 to 1.
Cloud cloud(std::size_t count) {
  Cloud result;
  signal::Gaussian gaussian(1, 1);
  for (std::size_t n = 0; n < count; ++n) {
    result.x.push_back(gaussian.uniform());
    result.y.push_back(result.x.back() + 0.3 * gaussian());
  }
  result.weight.assign(count, 1.0);
  return result;
}

TEST(BinningTest, MeansLieWithinTheirErrors) {
  const Cloud c = cloud(10'000);
  const BinAxis axis{0.0, 1.0, 10};
  const BinnedMeans sut = binned_means(axis, c.x, c.y, c.weight, 1.0);
  ASSERT_EQ(sut.mean.size(), 10U);
  for (std::size_t b = 0; b < 10; ++b) {
    // Noise and the slope within a bin, 0.1/sqrt(12): the deviation known to a twentieth.
    const double error = std::hypot(0.3, 0.1 / std::sqrt(12.0)) / std::sqrt(1000.0);
    EXPECT_NEAR(sut.standard_error[b], error, 0.15 * error);
    EXPECT_NEAR(sut.mean[b], sut.centre[b], 4.0 * error);
  }
}

TEST(BinningTest, CorrelatedSamplesCountOncePerCorrelationLength) {
  const Cloud c = cloud(10'000);
  const BinAxis axis{0.0, 1.0, 10};
  const BinnedMeans once = binned_means(axis, c.x, c.y, c.weight, 1.0);
  const BinnedMeans sut = binned_means(axis, c.x, c.y, c.weight, 9.0);
  // sqrt(9), and n - 1 in place of n: half a percent.
  EXPECT_NEAR(sut.standard_error[3] / once.standard_error[3], 3.0, 0.03);
}

TEST(BinningTest, ABinOfFourSamplesIsLeftOut) {
  const BinAxis axis{0.0, 1.0, 2};
  const std::vector<double> x{0.1, 0.2, 0.3, 0.4, 0.6, 0.7, 0.8, 0.9, 0.95};
  const std::vector<double> ones(x.size(), 1.0);
  EXPECT_THAT(binned_means(axis, x, ones, ones, 1.0).centre, testing::ElementsAre(0.75));
}

TEST(BinningTest, SamplesWithoutWeightDontCount) {
  Cloud c = cloud(1000);
  const BinAxis axis{0.0, 1.0, 5};
  const BinnedMeans before = binned_means(axis, c.x, c.y, c.weight, 1.0);
  for (int n = 0; n < 100; ++n) {
    c.x.push_back(0.5);
    c.y.push_back(1e6);
    c.weight.push_back(0.0);
  }
  EXPECT_EQ(binned_means(axis, c.x, c.y, c.weight, 1.0).mean, before.mean);
}

TEST(BinningTest, ShareBetweenBinsIsOneForAFunctionAndSmallForNoise) {
  const Cloud c = cloud(10'000);
  const BinAxis axis{0.0, 1.0, 20};
  std::vector<double> square = c.x;
  for (double& value : square) value *= value;
  // Within a bin of 1/20 x^2 varies by at most 2/20/sqrt(12): 0.0008 of a variance of 0.089.
  EXPECT_GT(share_between_bins(axis, c.x, square, c.weight), 0.99);
  signal::Gaussian gaussian(1, 2);
  std::vector<double> noise(c.x.size());
  for (double& value : noise) value = gaussian();
  // About bins / samples = 0.002.
  EXPECT_LT(share_between_bins(axis, c.x, noise, c.weight), 0.01);
}

TEST(BinningTest, OutliersDontStretchTheAxis) {
  Cloud c = cloud(10'000);
  c.x[17] = 1e9;
  c.x[18] = NAN;
  const BinAxis sut = axis_over(c.x, c.weight, 10);
  EXPECT_LT(sut.high, 1.0);
  EXPECT_EQ(sut.bin_of(NAN), sut.count);
}

TEST(BinningTest, AConstantHasAnAxisAllTheSame) {
  const std::vector<double> x(100, 3.0);
  const std::vector<double> ones(100, 1.0);
  const BinAxis sut = axis_over(x, ones, 10);
  EXPECT_GT(sut.high, sut.low);
  EXPECT_EQ(share_between_bins(sut, x, ones, ones), 0.0);
}

}  // namespace stillhand::diagnose::binning_test
