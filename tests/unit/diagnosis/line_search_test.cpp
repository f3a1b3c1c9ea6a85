// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/line_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::line_search_test {

constexpr std::size_t kCount = 6000;

std::vector<double> clock(double start_s = 0.0) {
  std::vector<double> t_s(kCount);
  for (std::size_t n = 0; n < kCount; ++n) {
    t_s[n] = start_s + static_cast<double>(n) / made::kRateHz;
  }
  return t_s;
}

std::vector<double> sine_over(const std::vector<double>& axis, double frequency, double amplitude) {
  std::vector<double> x(axis.size());
  for (std::size_t n = 0; n < axis.size(); ++n) {
    x[n] = amplitude * std::sin(2.0 * std::numbers::pi * frequency * axis[n] + 0.7);
  }
  return x;
}

void add(const std::vector<double>& more, std::vector<double>& sum) {
  for (std::size_t n = 0; n < sum.size(); ++n) sum[n] += more[n];
}

// Lines are tried in quarters of 1/range, 0.0042 Hz over 60 s, so the nearest lies within an
// eighth; noise moves a line far less (Rife and Boorstyn: 0.1 thousandth of 1/range here).
TEST(LineSearchTest, ALineBetweenTwoBinsIsFoundWithinAnEighthOfOneOverTheRange) {
  const auto t_s = clock();
  for (const double frequency_hz : {3.0, 3.005, 3.0083, 3.0125, 17.3719, 44.44}) {
    std::vector<double> residual = made::white(kCount, 11);
    add(sine_over(t_s, frequency_hz, 1.0), residual);
    const auto sut = strongest_lines(t_s, residual, 0.1, 48.0, 1);
    ASSERT_EQ(sut.size(), 1u);
    EXPECT_NEAR(sut.front().frequency, frequency_hz, 0.13 / 60.0) << frequency_hz;
  }
}

// Power of a line in the middle of a step: amplitude^2 n / 4, less at most sinc^2(1/8) = 0.95; the
// noise's own 1 adds or takes 2 sqrt(power) three times.
TEST(LineSearchTest, PowerAndProminenceAreThoseOfTheLine) {
  const auto t_s = clock();
  std::vector<double> residual = made::white(kCount, 12);
  add(sine_over(t_s, 3.0021, 0.5), residual);
  const auto sut = strongest_lines(t_s, residual, 0.1, 48.0, 1);
  const double power = 0.25 * 0.25 * kCount;  // 375
  EXPECT_NEAR(sut.front().power, 0.97 * power, 0.03 * power + 3.0 * 2.0 * std::sqrt(power));
  // The surroundings' median, 15 lines on each side: ln 2 = 0.69 of the noise, and the line's own
  // lobes, power / (2 (7.5 pi)^2) = 0.34 halfway out.
  EXPECT_GT(sut.front().prominence, sut.front().power / 1.7);
  EXPECT_LT(sut.front().prominence, sut.front().power / 0.5);
}

TEST(LineSearchTest, TwoLinesComeInOrderAndSideLobesDoNotCount) {
  const auto t_s = clock();
  const double turn_hz = 1.0 / (t_s.back() - t_s.front());
  std::vector<double> residual = sine_over(t_s, 300.0 * turn_hz, 1.0);
  add(sine_over(t_s, 304.0 * turn_hz, 0.8), residual);
  add(sine_over(t_s, 21.0, 0.2), residual);
  const auto sut = strongest_lines(t_s, residual, 0.1, 48.0, 3);
  ASSERT_EQ(sut.size(), 3u);
  // Of whole turns: each stands where the other's lobes are 0, and no nearer than 3/range (DG-15).
  EXPECT_NEAR(sut[0].frequency, 300.0 * turn_hz, 0.25 / 60.0);
  EXPECT_NEAR(sut[1].frequency, 304.0 * turn_hz, 0.25 / 60.0);
  // Lobes of the two, down to a tenth of their amplitude 3 to 8 lines away, may come before 21 Hz;
  // none of the lines is nearer than 3/range to a stronger one.
  for (std::size_t i = 0; i < sut.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GE(std::abs(sut[i].frequency - sut[j].frequency), 3.0 / 60.0);
      EXPECT_GE(sut[j].power, sut[i].power);
    }
  }
}

// A stick's angle, irregular: 0.35 rad of range, 60 periods a turn of 2 pi.
TEST(LineSearchTest, ALineOverAPositionIsFound) {
  std::vector<double> theta_rad = made::ride(kCount, 13, 0.1, 1.0);
  const auto [low, high] = std::ranges::minmax(theta_rad);
  for (double& x : theta_rad) x *= 0.35 / (high - low);
  const double per_rad = 60.0 / (2.0 * std::numbers::pi);
  std::vector<double> residual = made::white(kCount, 14);
  add(sine_over(theta_rad, per_rad, 1.0), residual);
  const auto sut = strongest_lines(theta_rad, residual, 1.5 / 0.35, 100.0, 1);
  ASSERT_EQ(sut.size(), 1u);
  // Positions gather in the middle, so the line is broader than over time: half of 1/range.
  EXPECT_NEAR(sut.front().frequency, per_rad, 0.5 / 0.35);
}

TEST(LineSearchTest, WhereTheAxisBeginsDoesNotMatter) {
  const auto early = clock();
  const auto late = clock(1000.0);
  const std::vector<double> residual = sine_over(early, 3.0, 1.0);
  const auto one = strongest_lines(early, residual, 0.1, 48.0, 1);
  const auto other = strongest_lines(late, residual, 0.1, 48.0, 1);
  // The step is the range's rounding, 1e-13 of it.
  EXPECT_NEAR(one.front().frequency, other.front().frequency, 1e-9);
}

TEST(LineSearchTest, WithoutARangeOrABandThereAreNoLines) {
  const std::vector<double> still(kCount, 1.0);
  EXPECT_TRUE(strongest_lines(still, made::white(kCount, 1), 0.1, 48.0, 3).empty());
  EXPECT_TRUE(strongest_lines(clock(), made::white(kCount, 1), 5.0, 5.0, 3).empty());
  EXPECT_TRUE(strongest_lines(clock(), made::white(kCount, 1), 5.0, 5.01, 3).empty());
}

}  // namespace stillhand::diagnosis::line_search_test
