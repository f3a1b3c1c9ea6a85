// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/bridge.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

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

// The sample in the middle of two inner rows d away and two outer ones D away weighs them by
// D^2/(D^2 - d^2)/2 and -d^2/(D^2 - d^2)/2.  Noise grows by 1.39, the root of the squares of 0.9
// and 0.4, in a long gap; two neighbouring rows would make it ten times as large.
TEST(BridgeTest, TheOuterRowsAreAQuarterOfTheGapOutAndHalfAPeriodAtLeast) {
  const auto weights = [](const std::vector<double>& places, std::size_t sample) {
    std::vector<double> out;
    for (std::size_t i = 0; i < places.size(); ++i) {
      std::vector<double> values(places.size(), 0.0);
      values[i] = 1.0;
      out.push_back(std::round(1e6 * on_grid(places, values, sample + 1)[sample]) / 1e6);
    }
    return out;
  };
  EXPECT_THAT(weights({0, 1, 2, 3, 4, 12, 13, 14, 15, 16}, 8),
              ElementsAre(0, 0, -0.4, 0, 0.9, 0.9, 0, -0.4, 0, 0));
  EXPECT_THAT(weights({0, 1, 1.15, 1.6, 2.4, 2.85, 3, 4}, 2),
              ElementsAre(0, -0.095238, 0, 0.595238, 0.595238, 0, -0.095238, 0));
  // Twice that and two periods out at most: 3 at a gap of 2.
  EXPECT_THAT(weights({0, 3, 5, 8}, 4), ElementsAre(-0.033333, 0.533333, 0.533333, -0.033333));
  EXPECT_THAT(weights({0, 3.25, 5.25, 8.5}, 4), ElementsAre(0, 0.625, 0.375, 0));
}

TEST(BridgeTest, AGapBesideAnEndIsBridgedWithThreeRows) {
  const std::vector<double> places{0.0, 3.0, 4.0, 5.0};
  const auto parabola = [](double x) { return 2.0 - x + 0.25 * x * x; };
  const auto sut = on_grid(places, of(places, parabola), 6);
  EXPECT_NEAR(sut[1], parabola(1.0), 1e-12);
  EXPECT_NEAR(sut[2], parabola(2.0), 1e-12);
  EXPECT_THAT(on_grid({0.0, 2.0}, {1.0, 5.0}, 3), ElementsAre(1.0, 3.0, 5.0));
}

TEST(BridgeTest, TheLargestNumbersStayFinite) {
  const double huge = 1.7e308;
  const auto sut = on_grid({0.0, 1.0, 4.0, 5.0}, {-huge, huge, -huge, huge}, 6);
  for (const double value : sut) EXPECT_TRUE(std::isfinite(value)) << value;
  EXPECT_DOUBLE_EQ(sut[2], huge / 3.0) << "on a straight line";
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
  // Rows up to 1.5 periods apart are jitter; a sample within half of one from a row counts.
  for (const double after : {2.75, 2.875}) {
    sut.clear();
    append_weights(std::vector<double>{0.0, 1.25, after, 4.0}, 5, sut);
    EXPECT_THAT(sut, ElementsAre(1.0, 1.0, after == 2.75 ? 1.0 : 0.0, 1.0, 1.0));
  }
  sut.clear();
  append_weights(std::vector<double>{0.0, 1.5, 3.5, 4.0}, 5, sut);
  EXPECT_THAT(sut, Each(1.0));
}

}  // namespace stillhand::measurement::bridge_test
