// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/model/interpolation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::interpolation_test {

using testing::ElementsAre;

constexpr std::size_t kCount = 401;

std::vector<double> sine(double frequency_hz, double phase_rad = 0.3) {
  std::vector<double> x(kCount);
  for (std::size_t n = 0; n < kCount; ++n) {
    x[n] = std::sin(2.0 * std::numbers::pi * frequency_hz * static_cast<double>(n) / made::kRateHz +
                    phase_rad);
  }
  return x;
}

Signals signals_of(const std::vector<double>& x) {
  return {
      made::measurement_of({{"u", "m/s^2", x}, {"y", "N", made::white(x.size(), 1)}}), {"u"}, "y"};
}

double largest_error(double frequency_hz, const std::function<double(double)>& delay_s) {
  const auto x = sine(frequency_hz);
  const auto sut = delayed(x, signals_of(x), delay_s);
  double largest = 0.0;
  for (std::size_t n = 30; n + 30 < kCount; ++n) {
    const double t_s = static_cast<double>(n) / made::kRateHz;
    const double want =
        std::sin(2.0 * std::numbers::pi * frequency_hz * (t_s - delay_s(t_s)) + 0.3);
    largest = std::max(largest, std::abs(sut[n] - want));
  }
  return largest;
}

// Halfway between two samples the six weights have the response cos(w/2) (1 + s/2 + 3 s^2/8),
// s = sin^2(w/2): short of 1 by 5/16 s^3 (1 + s ...); elsewhere less.  w = 2 pi f / rate.
double halfway_error(double frequency_hz) {
  const double s = std::pow(std::sin(std::numbers::pi * frequency_hz / made::kRateHz), 2);
  return 1.0 - std::sqrt(1.0 - s) * (1.0 + s / 2.0 + 3.0 * s * s / 8.0);
}

TEST(InterpolationTest, ADelayOfWholeSamplesIsExact) {
  const auto x = made::white(kCount, 2);
  // 25 samples: 0.25 s times 100 Hz is exact in binary.
  const auto sut = delayed(x, signals_of(x), [](double) { return 0.25; });
  for (std::size_t n = 30; n < kCount; ++n) ASSERT_EQ(sut[n], x[n - 25]) << n;
  EXPECT_EQ(delayed(x, signals_of(x), [](double) { return 0.0; }), x);
}

TEST(InterpolationTest, ADelayedSineIsTheSineOfTheDelayedTime) {
  for (const double frequency_hz : {0.5, 2.0, 5.0, 8.0}) {
    for (const double delay_s : {0.005, 0.0371, -0.0129, 0.123}) {
      // 1e-12: 400 roundings of the sine's argument.
      EXPECT_LE(largest_error(frequency_hz, [&](double) { return delay_s; }),
                halfway_error(frequency_hz) + 1e-12)
          << frequency_hz << " Hz, " << delay_s << " s";
    }
  }
}

TEST(InterpolationTest, TheErrorHalfwayIsThatOfLagrangesPolynomial) {
  // At a twentieth of the rate, the highest that the working rate leaves, 5e-6; at an eighth 1e-3;
  // at a quarter 5 %.  No frequency divides the rate, so some sample comes within 1 % of the crest.
  for (const double frequency_hz : {5.03, 12.41, 24.93}) {
    const double sut = largest_error(frequency_hz, [](double) { return 0.005; });
    EXPECT_LE(sut, 1.000001 * halfway_error(frequency_hz));
    EXPECT_GE(sut, 0.99 * halfway_error(frequency_hz));
  }
  EXPECT_NEAR(halfway_error(5.0), 4.5e-6, 0.5e-6);
  EXPECT_NEAR(halfway_error(12.5), 1.1e-3, 0.1e-3);
}

// Six points hold a polynomial of degree five: exact but for rounding, weights of at most 1 each.
TEST(InterpolationTest, AQuinticIsReproduced) {
  const auto quintic = [](double t_s) {
    return 1.0 + t_s * (-2.0 + t_s * (0.5 + t_s * (0.3 + t_s * (-0.2 + 0.04 * t_s))));
  };
  std::vector<double> x(kCount);
  for (std::size_t n = 0; n < kCount; ++n) x[n] = quintic(static_cast<double>(n) / made::kRateHz);
  for (const double delay_s : {0.0013, 0.0049, 0.0267, -0.0071}) {
    const auto sut = delayed(x, signals_of(x), [&](double) { return delay_s; });
    for (std::size_t n = 10; n + 10 < kCount; ++n) {
      const double want = quintic(static_cast<double>(n) / made::kRateHz - delay_s);
      // Values below 12: some ulps of 2e-15.
      ASSERT_NEAR(sut[n], want, 1e-13) << n << ", " << delay_s << " s";
      ASSERT_NEAR(value_at(x, static_cast<double>(n) - delay_s * made::kRateHz), want, 1e-13);
    }
  }
}

TEST(InterpolationTest, TheEdgesOfAStretchAreHeldAndNothingLeaksOver) {
  Measurement measurement =
      made::measurement_of({{"u", "m/s^2", {1.0, 2.0, 3.0, 4.0, 50.0, 60.0, 70.0, 80.0}},
                            {"y", "N", {1.0, 0.0, 2.0, 0.0, 1.0, 3.0, 0.0, 1.0}}},
                           1.0);
  measurement = made::cut_in_two(measurement, 4, 5.0);
  const Signals signals(measurement, {"u"}, "y");
  const auto& u = signals.inputs().front().values;
  EXPECT_THAT(delayed(u, signals, [](double) { return 2.0; }),
              ElementsAre(1.0, 1.0, 1.0, 2.0, 50.0, 50.0, 50.0, 60.0));
  EXPECT_THAT(delayed(u, signals, [](double) { return -3.0; }),
              ElementsAre(4.0, 4.0, 4.0, 4.0, 80.0, 80.0, 80.0, 80.0));
  EXPECT_THAT(delayed(u, signals, [](double) { return 1e9; }),
              ElementsAre(1.0, 1.0, 1.0, 1.0, 50.0, 50.0, 50.0, 50.0));
}

}  // namespace stillhand::diagnosis::interpolation_test
