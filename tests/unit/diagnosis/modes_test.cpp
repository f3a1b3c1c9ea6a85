// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/model/modes.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/core/diagnosis/model/evaluation.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::modes_test {

constexpr std::size_t kCount = 2000;

Body with_poles(const std::vector<double>& denominator, std::vector<double> numerator) {
  return {.numerators = {std::move(numerator)}, .denominator = denominator};
}

// By hand: at a quarter of the rate w is pi/2; undamped, the poles are +-i, 1 + q^-2.
TEST(ModesTest, AModesPolesAreThoseOfTheMatchedZTransform) {
  const auto undamped = mode_denominator(25.0, 0.0, 100.0);
  EXPECT_NEAR(undamped[1], 0.0, 1e-15);
  EXPECT_DOUBLE_EQ(undamped[2], 1.0);
  // Radius e^(-zw) squared, e^(-2 z w) with w = 2 pi 2/100 and z = 0.3.
  EXPECT_NEAR(mode_denominator(2.0, 0.3, 100.0)[2], std::exp(-0.6 * 0.12566370614359173), 1e-15);
  // Overdamped ratios are taken as critical: a double real pole.
  const auto critical = mode_denominator(2.0, 1.0, 100.0);
  EXPECT_NEAR(critical[1] * critical[1], 4.0 * critical[2], 1e-15);
}

TEST(ModesTest, APolynomialsProductIsTheConvolution) {
  EXPECT_EQ(product({1.0, -2.0}, {3.0, 0.5, 1.0}), (std::vector<double>{3.0, -5.5, 0.0, -2.0}));
}

// Eq. DG-38: the two parts together answer as the whole, for every mode that is taken out.
TEST(ModesTest, RestAndModeTogetherAreTheBody) {
  const auto slow = mode_denominator(1.1, 0.03, made::kRateHz);
  const auto middle = mode_denominator(3.7, 0.25, made::kRateHz);
  const auto fast = mode_denominator(9.0, 0.4, made::kRateHz);
  const Body body =
      with_poles(product(product(slow, middle), fast), {0.02, -0.3, 0.7, -0.4, 0.1, 0.05, -0.06});
  const auto splits = split_modes(body, made::kRateHz);
  ASSERT_EQ(splits.size(), 3U);
  const std::vector<double> u = made::white(kCount, 1);
  const auto whole = made::answer(body, u);
  double frequencies_hz = 0.0;
  for (const SplitBody& split : splits) {
    frequencies_hz += split.frequency_hz;
    ASSERT_EQ(split.rest.order(), 4U);
    const auto rest = made::answer(split.rest, u);
    const auto mode =
        made::answer({split.mode[0][0], split.mode[0][1]},
                     mode_denominator(split.frequency_hz, split.damping_ratio, made::kRateHz), u);
    double largest = 0.0;
    for (std::size_t n = 0; n < kCount; ++n) {
      largest = std::max(largest, std::abs(rest[n] + mode[n] - whole[n]));
    }
    // The parts nearly cancel between neighbouring modes: rounding times their ratio to the whole.
    EXPECT_LT(largest, 1e-8 * made::rms_of(whole)) << split.frequency_hz;
  }
  EXPECT_NEAR(frequencies_hz, 1.1 + 3.7 + 9.0, 1e-9);
}

TEST(ModesTest, EveryInputIsSplitWithTheSamePoles) {
  Body body = with_poles(
      product(mode_denominator(2.0, 0.1, made::kRateHz), mode_denominator(6.0, 0.2, made::kRateHz)),
      {0.1, 0.2, -0.1, 0.3, 0.0});
  body.numerators.push_back({0.0, 1.0, 0.0, 0.0, 0.0});
  for (const SplitBody& split : split_modes(body, made::kRateHz)) {
    EXPECT_EQ(split.mode.size(), 2U);
    EXPECT_EQ(split.rest.numerators.size(), 2U);
    EXPECT_EQ(split.rest.numerators[1].size(), 3U);
  }
}

TEST(ModesTest, WithoutAModeToTakeOutNothingIsSplit) {
  EXPECT_TRUE(split_modes(made::two_pole_body(), made::kRateHz).empty());
  EXPECT_TRUE(
      split_modes(with_poles({1.0, -1.2, 0.47, -0.06}, {1.0, 0.0, 0.0, 0.0}), 100.0).empty());
}

}  // namespace stillhand::diagnosis::modes_test
