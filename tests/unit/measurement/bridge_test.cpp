// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/bridge.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "services/core/signal/random.hpp"

namespace stillhand::measurement::bridge_test {

using testing::Each;
using testing::ElementsAre;

// Places 0 to count - 1 without [first, first + missing).
std::vector<double> without(int count, int first, int missing) {
  std::vector<double> places;
  for (int i = 0; i < count; ++i) {
    if (i < first || i >= first + missing) places.push_back(i);
  }
  return places;
}

std::vector<double> on_grid(const std::vector<double>& places, const std::vector<double>& values,
                            std::size_t samples) {
  std::vector<double> out;
  append_on_grid(places, values, samples, out);
  return out;
}

std::vector<double> of(const std::vector<double>& places, double (*value)(double)) {
  std::vector<double> values;
  for (const double place : places) values.push_back(value(place));
  return values;
}

double cubic(double x) { return 1.0 + x * (0.5 + x * (-0.03 + x * 0.0004)); }

TEST(BridgeTest, RowsOnTheGridAreTakenAsTheyAre) {
  const std::vector<double> places{0.0, 1.0, 2.0, 3.0};
  EXPECT_THAT(on_grid(places, {0.1, -7.0, 1e300, 4.0}, 4), ElementsAre(0.1, -7.0, 1e300, 4.0));
}

TEST(BridgeTest, ACubicIsBridgedExactly) {
  for (const int missing : {1, 2, 3, 5, 17, 50}) {
    const auto places = without(140, 60, missing);
    const auto sut = on_grid(places, of(places, cubic), 140);
    ASSERT_EQ(sut.size(), 140u);
    for (std::size_t n = 0; n < sut.size(); ++n) {
      // Values up to 700 and weights of order 1: rounding of 1e-12.
      ASSERT_NEAR(sut[n], cubic(static_cast<double>(n)), 1e-11) << missing << " at " << n;
    }
  }
}

TEST(BridgeTest, ACubicBetweenJitteredRowsIsFoundExactly) {
  signal::Gaussian random(3, 0);
  std::vector<double> places{0.0};
  for (int i = 1; i < 300; ++i) places.push_back(i + 0.4 * (2.0 * random.uniform() - 1.0));
  const auto sut = on_grid(places, of(places, [](double x) { return cubic(x / 10.0); }), 299);
  for (std::size_t n = 0; n < sut.size(); ++n) {
    // From the third period on four rows are at hand, to the third before the end.
    if (n < 3 || n > 295) continue;
    ASSERT_NEAR(sut[n], cubic(static_cast<double>(n) / 10.0), 1e-11) << n;
  }
}

// The cubic's error is f'''' times the product of the distances over 4!; in the middle of h = 51
// periods with the outer rows 13 further: (w h)^4 (1/2)^2 (1/2 + 13/51)^2 / 24, w the sine's
// angular frequency a period.  4 Hz, the paper's upper edge, at 1 kHz: 4.0 times 0.143 / 24 = 1.6
// %.
TEST(BridgeTest, AFiftyMillisecondGapInTheExcitedBandCostsLessThanTwoPercent) {
  const auto wave = [](double x) { return std::sin(2.0 * std::numbers::pi * 0.004 * x); };
  double worst = 0.0;
  for (int first = 300; first < 550; first += 7) {
    const auto places = without(1000, first, 50);
    const auto sut = on_grid(places, of(places, wave), 1000);
    for (int n = first; n < first + 50; ++n) {
      worst = std::max(worst, std::abs(sut[static_cast<std::size_t>(n)] - wave(n)));
    }
  }
  EXPECT_LT(worst, 0.02);
  EXPECT_GT(worst, 0.01);
}

// With the outer rows a quarter of the gap out the weights in its middle are -0.4, 0.9, 0.9, -0.4:
// noise grows by the root of their squares, 1.39.  Two neighbouring rows would make it ten times as
// large.
TEST(BridgeTest, NoiseIsHardlyAmplifiedInALongGap) {
  signal::Gaussian random(5, 0);
  double sum = 0.0;
  constexpr int kRuns = 4000;
  const auto places = without(200, 75, 50);
  for (int run = 0; run < kRuns; ++run) {
    std::vector<double> values;
    for (std::size_t i = 0; i < places.size(); ++i) values.push_back(random());
    const double middle = on_grid(places, values, 200)[100];
    sum += middle * middle;
  }
  // A variance from 4000 draws is good to 2.2 % at one sigma.
  EXPECT_NEAR(std::sqrt(sum / kRuns), 1.39, 0.06);
}

TEST(BridgeTest, AGapBesideAnEndIsBridgedWithThreeRows) {
  const std::vector<double> places{0.0, 3.0, 4.0, 5.0};
  const auto parabola = [](double x) { return 2.0 - x + 0.25 * x * x; };
  const auto sut = on_grid(places, of(places, parabola), 6);
  EXPECT_NEAR(sut[1], parabola(1.0), 1e-12);
  EXPECT_NEAR(sut[2], parabola(2.0), 1e-12);
  EXPECT_THAT(on_grid({0.0, 2.0}, {1.0, 5.0}, 3), ElementsAre(1.0, 3.0, 5.0));
}

TEST(BridgeTest, RowsBehindAnotherGapHaveNoSay) {
  // One row between two gaps of ten: the rows 11 periods away are further than the cubic reaches.
  std::vector<double> places = without(30, 0, 0);
  std::erase_if(places, [](double p) { return (p > 5 && p < 15) || (p > 15 && p < 25); });
  std::vector<double> values(places.size(), 1.0);
  values.back() = 1e6;
  const auto sut = on_grid(places, values, 30);
  EXPECT_THAT(std::vector<double>(sut.begin(), sut.begin() + 25),
              Each(testing::DoubleNear(1.0, 1e-9)));
}

TEST(BridgeTest, TheLargestNumbersStayFinite) {
  const double huge = 1.7e308;
  const auto sut = on_grid({0.0, 1.0, 4.0, 5.0}, {-huge, huge, -huge, huge}, 6);
  for (const double value : sut) EXPECT_TRUE(std::isfinite(value)) << value;
}

TEST(BridgeTest, TimesThatDifferInTheLastDigitOnlyStayFinite) {
  const double near = std::nextafter(1.3, 2.0);
  const auto sut = on_grid({0.0, 1.3, near, 2.6, 3.9}, {0.0, 1.0, 3.0, 4.0, 5.0}, 4);
  for (const double value : sut) {
    EXPECT_GE(value, -1.0);
    EXPECT_LE(value, 6.0);
  }
}

TEST(BridgeTest, OnlySamplesInsideAGapWeighNothing) {
  std::vector<double> sut;
  append_weights(std::vector<double>{0.0, 1.0, 4.0, 5.0}, 6, sut);
  EXPECT_THAT(sut, ElementsAre(1.0, 1.0, 0.0, 0.0, 1.0, 1.0));
  sut.clear();
  // Rows 2.4 periods apart: the sample a fifth of a period from one counts, the other does not.
  append_weights(std::vector<double>{0.0, 0.8, 3.2, 4.0}, 5, sut);
  EXPECT_THAT(sut, ElementsAre(1.0, 1.0, 0.0, 1.0, 1.0));
  sut.clear();
  // Jitter alone is no gap.
  append_weights(std::vector<double>{0.0, 0.7, 2.1, 3.0}, 4, sut);
  EXPECT_THAT(sut, Each(1.0));
}

}  // namespace stillhand::measurement::bridge_test
