// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/spectrum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/signal/random.hpp"

namespace stillhand::signal::spectrum_test {
namespace {

std::vector<double> white(std::size_t count, std::uint64_t seed) {
  Gaussian draw(seed, 1);
  std::vector<double> out(count);
  for (double& x : out) x = draw();
  return out;
}

// H(z) = 1 + 0.5/z - 0.3/z^2: two samples of memory, so that a long segment sees no truncation.
std::vector<double> through_fir(const std::vector<double>& x) {
  std::vector<double> y(x.size(), 0.0);
  for (std::size_t n = 2; n < x.size(); ++n) y[n] = x[n] + 0.5 * x[n - 1] - 0.3 * x[n - 2];
  return y;
}
std::complex<double> fir_response(double frequency_hz, double rate_hz) {
  const auto back = std::polar(1.0, -kTwoPi * frequency_hz / rate_hz);
  return 1.0 + 0.5 * back - 0.3 * back * back;
}

TEST(SpectrumTest, DensityOfASineIntegratesToItsPower) {
  // 25 Hz sits on line 100 of a 4 s segment: the Hann window spreads it over lines 99 to 101 and
  // nothing else, so the three hold A^2/2 exactly.
  constexpr double kRate = 100.0;
  std::vector<double> x(4000);
  for (std::size_t n = 0; n < x.size(); ++n) {
    x[n] = 3.0 * std::sin(kTwoPi * 25.0 * static_cast<double>(n) / kRate + 0.4);
  }
  const auto sut = cross_spectra(x, x, kRate, 400);
  const double width_hz = kRate / 400.0;
  EXPECT_NEAR((sut.s_xx[99] + sut.s_xx[100] + sut.s_xx[101]) * width_hz, 4.5, 1e-10);
  EXPECT_NEAR(sut.s_xx[97], 0.0, 1e-20);
  EXPECT_DOUBLE_EQ(sut.frequency_hz[100], 25.0);
  // 19 segments in 4000 samples, Eq. SG-10: 1 + (18/19)/18 = 20/19.
  EXPECT_DOUBLE_EQ(sut.independent_averages, 19.0 * 19.0 / 20.0);
}

// The lines at 0 and at half the rate stand for one side of the spectrum.  Transforms of the window
// by hand: an alternating 1 has L/2 at the last line and L/4 next to it, so 2/3 and 1/3 of its
// power of 1; cos(2 pi n/L) has L/4 at the first two, so 1/6 and 1/3.
TEST(SpectrumTest, TheLinesAtBothEndsHaveOneSide) {
  std::vector<double> alternating(64);
  std::vector<double> slow(64);
  for (std::size_t n = 0; n < slow.size(); ++n) {
    alternating[n] = n % 2 == 0 ? 1.0 : -1.0;
    slow[n] = std::cos(kTwoPi * static_cast<double>(n) / 16.0);
  }
  const auto sut = cross_spectra(alternating, slow, 16.0, 16);  // lines are 1 Hz wide
  EXPECT_NEAR(sut.s_xx[8], 2.0 / 3.0, 1e-14);
  EXPECT_NEAR(sut.s_xx[7], 1.0 / 3.0, 1e-14);
  EXPECT_NEAR(sut.s_yy[0], 1.0 / 6.0, 1e-14);
  EXPECT_NEAR(sut.s_yy[1], 1.0 / 3.0, 1e-14);
}

TEST(SpectrumTest, NoiseFreeResponseIsThatOfTheFilter) {
  const auto x = white(100'000, 3);
  const auto sut = transfer_estimate(cross_spectra(x, through_fir(x), 50.0, 2000));
  for (std::size_t k = 1; k + 1 < sut.response.size(); ++k) {
    // Leakage: a delay of 2 of 2000 samples shifts the window, a relative error of order 2/2000 x
    // 2 pi on each segment, random in sign over 99 segments: 6e-4, and three times that.
    EXPECT_LT(std::abs(sut.response[k] - fir_response(sut.frequency_hz[k], 50.0)), 2e-3);
    // 1 - g^2 is the mean square of the segments' own errors: 99 averages times (2e-3)^2.
    EXPECT_GT(sut.coherence[k], 1.0 - 4e-4);
  }
}

TEST(SpectrumTest, CoherenceFollowsTheNoise) {
  // g^2 = S_yy without noise over S_yy with it, at each line.  Deviation of one estimate is
  // sqrt(2) (1 - g^2) / sqrt(n_d) g^2 (Bendat and Piersol); the mean over lines is what is judged.
  const auto x = white(200'000, 4);
  auto y = through_fir(x);
  const auto noise = white(y.size(), 5);
  for (std::size_t n = 0; n < y.size(); ++n) y[n] += noise[n];
  const auto spectra = cross_spectra(x, y, 100.0, 500);
  const auto sut = coherence(spectra);
  double bias = 0.0;
  for (std::size_t k = 1; k + 1 < sut.size(); ++k) {
    const double power = std::norm(fir_response(spectra.frequency_hz[k], 100.0));
    const double expected = power / (power + 1.0);
    const double deviation =
        std::sqrt(2.0 * expected / spectra.independent_averages) * (1.0 - expected);
    EXPECT_NEAR(sut[k], expected, 5.0 * deviation + 1.0 / spectra.independent_averages);
    bias += sut[k] - expected;
  }
  // Bias of one estimate is (1 - g^2)^2 / n_d, at most 1/755.
  EXPECT_NEAR(bias / static_cast<double>(sut.size() - 2), 0.0, 2e-3);
}

TEST(SpectrumTest, ConfidenceIntervalHoldsTheTruthNineteenTimesInTwenty) {
  const auto x = white(200'000, 8);
  auto y = through_fir(x);
  const auto noise = white(y.size(), 9);
  for (std::size_t n = 0; n < y.size(); ++n) y[n] += noise[n];
  const auto sut = transfer_estimate(cross_spectra(x, y, 100.0, 2000));
  int inside = 0;
  int lines = 0;
  for (std::size_t k = 1; k + 1 < sut.response.size(); ++k, ++lines) {
    const double truth = std::abs(fir_response(sut.frequency_hz[k], 100.0));
    const double error = std::abs(std::abs(sut.response[k]) / truth - 1.0);
    inside += error <= sut.magnitude_ci95[k] ? 1 : 0;
  }
  // 999 lines, neighbours correlated by the window (about 500 independent): 0.95 +- 4 * 0.0097.
  EXPECT_NEAR(static_cast<double>(inside) / lines, 0.95, 0.039);
}

TEST(SpectrumTest, IntervalIsUnboundedWithoutCoherence) {
  const std::vector<double> zero(64, 0.0);
  const auto sut = transfer_estimate(cross_spectra(white(64, 1), zero, 10.0, 16));
  EXPECT_TRUE(std::isinf(sut.magnitude_ci95[3]));
  EXPECT_EQ(sut.response[3], std::complex<double>(0.0));
  const auto unmoved = transfer_estimate(cross_spectra(zero, white(64, 1), 10.0, 16));
  EXPECT_EQ(unmoved.response[3], std::complex<double>(0.0));
}

TEST(SpectrumTest, LineIsExactForWholeCycles) {
  // 180 s at 1 kHz, no power of two; another line must not leak in.
  std::vector<double> x(180'000);
  for (std::size_t n = 0; n < x.size(); ++n) {
    const auto cycles = [&](std::size_t h) {
      return kTwoPi * static_cast<double>(h * n % x.size()) / static_cast<double>(x.size());
    };
    x[n] = 0.02 * std::cos(cycles(719) + 1.1) + 3.0 * std::cos(cycles(718) - 0.3) + 5.0;
  }
  // Stated bound: 1e-14 of max |x|, here 8.
  EXPECT_LT(std::abs(line_at(x, 719) - std::polar(0.02, 1.1)), 8e-14);
  EXPECT_LT(std::abs(line_at(x, 718) - std::polar(3.0, -0.3)), 8e-14);
  EXPECT_LT(std::abs(line_at(x, 717)), 8e-14);
}

TEST(SpectrumTest, LineWorksForEveryLength) {
  // Lengths around the block of 512, odd, prime; oracle is the plain sum in long double.
  for (const std::size_t count : {5u, 511u, 512u, 513u, 1025u, 4999u}) {
    const auto x = white(count, count);
    std::complex<long double> sum = 0.0L;
    for (std::size_t n = 0; n < count; ++n) {
      const long double angle = 2.0L * std::numbers::pi_v<long double> *
                                static_cast<long double>(2 * n % count) /
                                static_cast<long double>(count);
      sum += static_cast<long double>(x[n]) *
             std::complex<long double>(std::cos(angle), -std::sin(angle));
    }
    const auto expected = std::complex<double>(sum * (2.0L / static_cast<long double>(count)));
    EXPECT_LT(std::abs(line_at(x, 2) - expected), 5e-14) << count;
  }
}

TEST(SpectrumTest, WhatCannotBeEstimatedIsRefused) {
  const std::vector<double> x(100, 1.0);
  EXPECT_THROW(cross_spectra(x, std::vector<double>(99, 1.0), 10.0, 20), ConfigError);
  EXPECT_THROW(cross_spectra(x, x, 10.0, 21), ConfigError);
  EXPECT_THROW(cross_spectra(x, x, 10.0, 102), ConfigError);
  EXPECT_THROW(cross_spectra(x, x, 10.0, 6), ConfigError);
  EXPECT_NO_THROW(cross_spectra(x, x, 10.0, 8));
  EXPECT_NO_THROW(cross_spectra(x, x, 10.0, 100));
  EXPECT_THROW(cross_spectra(x, x, 0.0, 20), ConfigError);
  EXPECT_THROW(line_at(x, 0), ConfigError);
  EXPECT_THROW(line_at(x, 50), ConfigError);
}

}  // namespace
}  // namespace stillhand::signal::spectrum_test
