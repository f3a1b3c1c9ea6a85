// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/impulse_response.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::impulse_response_test {

using made::signals_of;
using made::sum_of;

constexpr std::size_t kCount = 12000;

// y(n) = 0.5 + sum h_i u(n-i), 20 taps that die away.
std::vector<double> finite_response(const std::vector<double>& u) {
  std::vector<double> h(20);
  for (std::size_t i = 0; i < h.size(); ++i) {
    h[i] = std::exp(-0.2 * static_cast<double>(i)) * std::cos(0.5 * static_cast<double>(i));
  }
  std::vector<double> y = made::answer(h, {1.0}, u);
  for (double& value : y) value += 0.5;
  return y;
}

// White input, so that every tap is determined: to rounding and the ridge of 1e-9.
TEST(ImpulseResponseTest, AKnownFiniteResponseIsFound) {
  const auto u = made::white(kCount, 1);
  const auto y = finite_response(u);
  const ImpulseResponse sut = fit_impulse_response(signals_of(u, y));
  EXPECT_EQ(sut.lags, 150u) << "1.5 s";
  EXPECT_LT(sut.rmse, 1e-7);
  for (std::size_t n = 0; n < kCount; ++n) {
    // One sample is kept behind the last row.
    ASSERT_EQ(sut.valid[n], n >= 150 && n + 1 < kCount) << n;
    ASSERT_NEAR(sut.valid[n] ? sut.prediction[n] : y[n], y[n], 1e-6) << n;
  }
}

// sqrt(sum e^2 / (n - numbers)) of n = 11849 rows: 1 within three times 1/sqrt(2 n) = 0.65 %; not
// freed of its 151 numbers it would be 0.64 % lower.  The prediction's own error: sqrt(151/n) =
// 0.113 of the noise, a root of a chi-squared of 151 degrees: within three times 1/sqrt(2 151) = 17
// %.
TEST(ImpulseResponseTest, WhatAFiniteResponseLeavesIsTheNoise) {
  const auto u = made::white(kCount, 1);
  const auto y = finite_response(u);
  const auto noise = made::white(kCount, 2);
  const ImpulseResponse sut = fit_impulse_response(signals_of(u, sum_of(y, noise)));
  EXPECT_NEAR(sut.rmse, 1.0, 3.0 / std::sqrt(2.0 * 11849.0));
  double square = 0.0;
  for (std::size_t n = 150; n + 1 < kCount; ++n) square += std::pow(sut.prediction[n] - y[n], 2);
  EXPECT_NEAR(std::sqrt(square / 11849.0), std::sqrt(151.0 / 11849.0), 0.17 * 0.113);
}

// DG-13: a twentieth of the record over the number of inputs.
TEST(ImpulseResponseTest, TwoInputsShareTheLags) {
  const auto u = made::white(4000, 1);
  const auto v = made::white(4000, 2);
  const auto y = sum_of(finite_response(u), made::answer({0.3, 0.0, -0.2}, {1.0}, v));
  const Signals signals(made::measurement_of({{"u", "V", u}, {"v", "V", v}, {"y", "N", y}}),
                        {"u", "v"}, "y");
  const ImpulseResponse sut = fit_impulse_response(signals);
  EXPECT_EQ(sut.lags, 100u);
  EXPECT_LT(sut.rmse, 1e-6);
  const auto w = made::white(kCount, 3);
  const Signals fast(made::measurement_of({{"u", "V", w}, {"y", "N", w}}, 1000.0), {"u"}, "y");
  EXPECT_EQ(fit_impulse_response(fast).lags, 200u) << "1.5 s would be 1500";
}

TEST(ImpulseResponseTest, AFiniteResponseNeverReachesOverAGap) {
  const auto u = made::white(kCount, 1);
  Measurement measurement = made::measurement_of({{"u", "V", u}, {"y", "N", finite_response(u)}});
  // The third, of 301 samples, is too short for 150 lags and 150 rows.
  measurement.stretches = {{0, 5000, 0.0}, {5000, 11699, 60.0}, {11699, kCount, 200.0}};
  const ImpulseResponse sut = fit_impulse_response(Signals(measurement, {"u"}, "y"));
  EXPECT_TRUE(sut.valid[4998]);
  for (std::size_t n = 4999; n < 5150; ++n) EXPECT_FALSE(sut.valid[n]) << n;
  EXPECT_TRUE(sut.valid[5150]);
  for (std::size_t n = 11698; n < kCount; ++n) EXPECT_FALSE(sut.valid[n]) << n;
  // The true response is known behind a gap, too: its 20 taps lie within what is read.
  EXPECT_LT(sut.rmse, 1e-7);
}

TEST(ImpulseResponseTest, WithoutALongStretchThereIsNoFiniteResponse) {
  const auto u = made::white(1200, 1);
  Measurement measurement = made::measurement_of({{"u", "V", u}, {"y", "N", u}});
  measurement.stretches.clear();
  for (std::size_t n = 0; n < 1200; n += 100) {
    measurement.stretches.push_back({n, n + 100, 2.0 * static_cast<double>(n)});
  }
  // A twentieth of the record, 60 samples, twice and one more.
  const ImpulseResponse sut = fit_impulse_response(Signals(measurement, {"u"}, "y"));
  EXPECT_EQ(sut.lags, 60u);
  EXPECT_TRUE(std::isnan(sut.rmse));
}

}  // namespace stillhand::diagnosis::impulse_response_test
