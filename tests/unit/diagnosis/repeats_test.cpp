// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/repeats.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::repeats_test {

using made::column_of;

constexpr std::size_t kPeriod = 250;

// Noise and something that repeats and is far larger.
std::vector<double> repeating(const std::vector<double>& noise) {
  std::vector<double> r = noise;
  for (std::size_t n = 0; n < r.size(); ++n) {
    r[n] += 5.0 * std::sin(2.0 * std::numbers::pi * static_cast<double>(n % kPeriod) / kPeriod);
  }
  return r;
}

Repeats repeats_in(const std::vector<double>& residual, std::size_t periods) {
  const std::vector<double> all(residual.size(), 1.0);
  const auto result = repeated_residual({0, kPeriod, periods, 0.0}, column_of(residual), all);
  return result ? result->repeats : Repeats{};
}

// Noise of a colour, without its first 500 samples.
std::vector<double> settled(std::size_t periods, const std::vector<double>& colour,
                            std::uint64_t seed) {
  const auto noise = made::answer({1.0}, colour, made::white(periods * kPeriod + 500, seed));
  return {noise.begin() + 500, noise.end()};
}

// In how many of 400 recordings the interval holds the true value.
int covered(std::size_t periods, const std::vector<double>& colour, double deviation) {
  int inside = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const Repeats sut = repeats_in(repeating(settled(periods, colour, 1000 + seed)), periods);
    inside += sut.low < deviation && deviation < sut.high ? 1 : 0;
  }
  return inside;
}

// 95 % of 400 are 380 with a deviation of 4.4; four of these.
TEST(RepeatsTest, TheIntervalHoldsWhiteNoiseInNineteenOfTwentyRecordings) {
  EXPECT_NEAR(covered(2, {1.0}, 1.0), 380, 18);
  EXPECT_NEAR(covered(8, {1.0}, 1.0), 380, 18);
}

// AR(1) with 0.8: 1/sqrt(1 - 0.64).  The degrees of freedom are estimated from the same lines; with
// two periods (125 lines, of which some ten matter) that costs some coverage: 88 % are still
// wanted.
TEST(RepeatsTest, ColouredNoiseHasAWiderIntervalThatHoldsIt) {
  const double deviation = 1.0 / std::sqrt(1.0 - 0.64);
  EXPECT_NEAR(covered(8, {1.0, -0.8}, deviation), 376, 22);
  EXPECT_GT(covered(2, {1.0, -0.8}, deviation), 352);
}

TEST(RepeatsTest, DegreesOfFreedomAreThoseOfTheNoiseLines) {
  // 7/8 of 1000 lines of two degrees each; a ratio of sums of squares of 875 exponential deviates
  // has a deviation of 2/sqrt(875) = 7 %: twice that.
  const Repeats sut = repeats_in(repeating(made::white(8 * kPeriod, 13)), 8);
  EXPECT_NEAR(sut.degrees_of_freedom, 1750.0, 0.14 * 1750.0);
  EXPECT_EQ(sut.periods, 8u);
}

TEST(RepeatsTest, AFirstPeriodThatDiffersIsLeftOut) {
  std::vector<double> r = repeating(made::white(6 * kPeriod, 4));
  EXPECT_FALSE(repeats_in(r, 6).first_left_out);
  for (std::size_t n = 0; n < kPeriod; ++n) r[n] += 4.0 * std::exp(-static_cast<double>(n) / 60.0);
  const Repeats sut = repeats_in(r, 6);
  EXPECT_TRUE(sut.first_left_out);
  EXPECT_EQ(sut.periods, 5u);
  // 1000 samples: 2.2 % one deviation.
  EXPECT_NEAR(sut.rms, 1.0, 0.09);
  // Of two periods none can be left out.
  EXPECT_EQ(repeats_in({r.begin(), r.begin() + 2 * kPeriod}, 2).periods, 2u);
}

// 1 % of 400 are 4 with a deviation of 2; three and a half of these.
TEST(RepeatsTest, NoiseAloneRarelyLeavesAPeriodOut) {
  const auto left_out = [](const std::vector<double>& colour) {
    int count = 0;
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
      count += repeats_in(repeating(settled(5, colour, 7000 + seed)), 5).first_left_out ? 1 : 0;
    }
    return count;
  };
  EXPECT_LE(left_out({1.0}), 11);
  EXPECT_LE(left_out({1.0, -0.8}), 15);  // degrees of freedom are estimated too
}

TEST(RepeatsTest, SamplesThatDoNotCountAreLeftOut) {
  std::vector<double> r = repeating(made::white(6 * kPeriod, 5));
  std::vector<double> weight(r.size(), 1.0);
  for (std::size_t n = 0; n < r.size(); n += 20) {
    weight[n] = 0.0;
    r[n] = 0.0;
  }
  const Periodicity all{0, kPeriod, 6, 0.0};
  const auto sut = repeated_residual(all, column_of(r), weight);
  ASSERT_TRUE(sut.has_value());
  EXPECT_NEAR(sut->repeats.rms, 1.0, 0.09);
  for (std::size_t n = 0; n < r.size(); n += 8) weight[n] = 0.0;
  EXPECT_FALSE(repeated_residual(all, column_of(r), weight).has_value());
}

// Of two periods half of the mean square of their difference, where both samples count; the
// interval by Wilson and Hilferty's chi-square, to 1e-4.
TEST(RepeatsTest, OfTwoPeriodsTheNoiseIsThatOfTheirDifference) {
  const std::vector<double> r = repeating(made::white(2 * kPeriod, 6));
  std::vector<double> weight(r.size(), 1.0);
  for (std::size_t n = 0; n < r.size(); n += 11) weight[n] = 0.0;
  double square = 0.0;
  double count = 0.0;
  for (std::size_t n = 0; n < kPeriod; ++n) {
    const double both = weight[n] * weight[n + kPeriod];
    square += both * 0.5 * std::pow(r[n] - r[n + kPeriod], 2);
    count += both;
  }
  const auto result = repeated_residual({0, kPeriod, 2, 0.0}, column_of(r), weight);
  ASSERT_TRUE(result.has_value());
  const Repeats& sut = result->repeats;
  EXPECT_NEAR(sut.rms, std::sqrt(square / count), 1e-12);
  const double part = 2.0 / (9.0 * sut.degrees_of_freedom);
  EXPECT_NEAR(sut.low, sut.rms * std::pow(1.0 - part + 1.96 * std::sqrt(part), -1.5), 1e-4);
  EXPECT_NEAR(sut.high, sut.rms * std::pow(1.0 - part - 1.96 * std::sqrt(part), -1.5), 1e-4);
}

TEST(RepeatsTest, WhatRepeatsExactlyHasNoNoise) {
  EXPECT_FALSE(repeated_residual({0, kPeriod, 4, 0.0}, Eigen::VectorXd::Zero(4 * kPeriod),
                                 std::vector<double>(4 * kPeriod, 1.0))
                   .has_value());
}

}  // namespace stillhand::diagnosis::repeats_test
