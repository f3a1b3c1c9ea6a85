// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/difference_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stillhand::signal::difference_model_test {
namespace {

// f(n) = 2 a(n) + 3 a(n-1) + 0.5 f(n-1) - 0.25 f(n-2): so d_1 = -0.5, d_2 = 0.25 (Eq. SG-12).
DifferenceModel known() { return {50.0, {2.0, 3.0, 0.0}, {1.0, -0.5, 0.25}}; }

DifferenceModel with_poles(double radius, double angle_rad) {
  return {50.0, {1.0, 0.0, 0.0}, {1.0, -2.0 * radius * std::cos(angle_rad), radius * radius}};
}

TEST(DifferenceModelTest, FreeRunFollowsTheDifferenceEquation) {
  const auto f = simulated(known(), {1.0, 0.0, 0.0, 0.0});
  // By hand: 2; 3 + 0.5*2 = 4; 0.5*4 - 0.25*2 = 1.5; 0.5*1.5 - 0.25*4 = -0.25.  Exact in binary.
  EXPECT_EQ(f, (std::vector<double>{2.0, 4.0, 1.5, -0.25}));
}

TEST(DifferenceModelTest, ResponseIsThatOfTheEquation) {
  // At 0 Hz (2 + 3)/(1 - 0.5 + 0.25); at half the rate (2 - 3)/(1 + 0.5 + 0.25).
  EXPECT_NEAR(std::abs(response_at(known(), 0.0) - 5.0 / 0.75), 0.0, 1e-14);
  EXPECT_NEAR(std::abs(response_at(known(), 25.0) + 1.0 / 1.75), 0.0, 1e-14);
  // In between: gain and phase of the steady state that a cosine settles to.
  std::vector<double> a(400);
  const auto angle = [](std::size_t n) {
    return 2.0 * std::numbers::pi * 0.06 * static_cast<double>(n);
  };
  for (std::size_t n = 0; n < a.size(); ++n) a[n] = std::cos(angle(n));
  const auto f = simulated(known(), a);
  const auto h = response_at(known(), 3.0);
  // The transient has fallen by 0.5^300.
  EXPECT_NEAR(f[350], std::abs(h) * std::cos(angle(350) + std::arg(h)), 1e-12);
}

TEST(DifferenceModelTest, StabilityIsDecidedAtTheUnitCircle) {
  for (const double angle_rad : {0.0, 0.05, 1.0, 3.14159}) {
    EXPECT_TRUE(is_stable(with_poles(0.999, angle_rad))) << angle_rad;
    // Two poles at distance x from 1 leave the recursion x^2 / 2 from its bound, with a rounding of
    // 1e-16 / x: it can tell down to x = 6e-6.
    EXPECT_TRUE(is_stable(with_poles(1.0 - 1e-4, angle_rad))) << angle_rad;
    EXPECT_FALSE(is_stable(with_poles(1.0, angle_rad))) << angle_rad;
    EXPECT_FALSE(is_stable(with_poles(1.001, angle_rad))) << angle_rad;
  }
  // Three real poles: the largest decides.
  for (const double pole : {0.99, -0.99, 1.01, -1.01}) {
    const auto below = product({1.0, -pole}, product({1.0, 0.5}, {1.0, -0.3}));
    EXPECT_EQ(is_stable({50.0, {1.0, 0.0, 0.0, 0.0}, below}), std::abs(pole) < 1.0) << pole;
  }
  EXPECT_FALSE(is_stable({50.0, {1.0, 0.0}, {1.0, -1.0}})) << "an integrator";
  EXPECT_FALSE(is_stable({50.0, {1.0, 0.0}, {1.0, std::nan("")}}));
  EXPECT_TRUE(is_stable({50.0, {1.0}, {1.0}}));
}

TEST(DifferenceModelTest, PolesAreTheRootsOfTheDenominator) {
  const auto found = poles(with_poles(0.9, 0.7));
  ASSERT_EQ(found.size(), 2u);
  for (const auto& pole : found) {
    EXPECT_NEAR(std::abs(pole), 0.9, 1e-13);
    EXPECT_NEAR(std::abs(std::arg(pole)), 0.7, 1e-13);
  }
  EXPECT_EQ(poles({50.0, {1.0, 0.0}, {1.0, -0.5}}), (std::vector<std::complex<double>>{0.5}));
  EXPECT_TRUE(poles({50.0, {1.0}, {1.0}}).empty());
}

TEST(DifferenceModelTest, MalformedModelsAreSeen) {
  EXPECT_TRUE(well_formed(known()));
  EXPECT_FALSE(well_formed({}));
  EXPECT_FALSE(well_formed({50.0, {1.0, 2.0}, {1.0}}));
  EXPECT_FALSE(well_formed({50.0, {1.0}, {2.0}}));
  EXPECT_FALSE(well_formed({50.0, {INFINITY}, {1.0}}));
  EXPECT_FALSE(well_formed({50.0, {1.0, 1.0}, {1.0, std::nan("")}}));
  EXPECT_FALSE(well_formed({0.0, {1.0}, {1.0}}));
  EXPECT_FALSE(well_formed({std::nan(""), {1.0}, {1.0}}));
}

}  // namespace
}  // namespace stillhand::signal::difference_model_test
