// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/paper_preprocessing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/units.hpp"
#include "tests/support/feedthrough_records.hpp"

namespace stillhand::identification::paper_preprocessing_test {
namespace {

std::vector<double> sine(double frequency_hz, double rate_hz, double seconds) {
  std::vector<double> out;
  for (double n = 0.0; n < seconds * rate_hz; n += 1.0) {
    out.push_back(std::sin(kTwoPi * frequency_hz * n / rate_hz));
  }
  return out;
}

// Amplitude in the steady second half.
double amplitude(const std::vector<double>& x) {
  double power = 0.0;
  for (std::size_t n = x.size() / 2; n < x.size(); ++n) power += x[n] * x[n];
  return std::sqrt(2.0 * power / static_cast<double>(x.size() - x.size() / 2));
}

TEST(PaperPreprocessingTest, GivesFiftyHertzFromAnyRateAboveAHundred) {
  for (const double rate_hz : {100.0, 99.99995, 120.0, 200.0, 250.0, 512.0, 1000.0, 2048.0}) {
    const auto x = sine(2.0, rate_hz, 30.0);
    const Record sut = preprocessed({rate_hz, x, x});
    EXPECT_EQ(sut.rate_hz, 50.0);
    EXPECT_NEAR(static_cast<double>(sut.size()), 1500.0, 1.0) << rate_hz;
  }
}

TEST(PaperPreprocessingTest, TenHertzIsTheCutoff) {
  for (const double rate_hz : {100.0, 130.0, 1000.0}) {
    // Whole cycles in the second half: 20 s at 50 Hz, 500 samples.
    const auto at = [&](double f) {
      const auto x = sine(f, rate_hz, 20.0);
      return amplitude(preprocessed({rate_hz, x, x}).force_n);
    };
    // The anti-alias filter takes (10/40)^16 / 2 = 1e-10 at 10 Hz; the resampling kernel ripples by
    // less than 1e-3.  12.5 Hz is a quarter of 50 Hz, so its samples hold the amplitude's power
    // too.
    EXPECT_NEAR(at(10.0), std::numbers::sqrt2 / 2.0, 1e-3) << rate_hz;
    EXPECT_NEAR(at(2.0), 1.0, 1e-3) << rate_hz;
    EXPECT_LT(at(20.0), 0.025) << rate_hz;  // prewarped: (tan 36/tan 18)^-5 = 0.018
  }
}

TEST(PaperPreprocessingTest, NothingAboveHalfTheRateFoldsBack) {
  // 98 Hz at 1 kHz would come out as 2 Hz.  Order 8 at 40 Hz: (98/40)^-8 = 8e-4 and less by
  // warping.
  const auto x = sine(98.0, 1000.0, 20.0);
  EXPECT_LT(amplitude(preprocessed({1000.0, x, x}).force_n), 8e-4);
}

TEST(PaperPreprocessingTest, ResponseBetweenTheChannelsStays) {
  // Force is the acceleration times -3.2: so it must be afterwards, at any rate.
  for (const double rate_hz : {100.0, 333.0, 1000.0}) {
    const auto count = static_cast<std::size_t>(60.0 * rate_hz);
    const auto a = support::band_noise(count, rate_hz, 0.7, 4.0, 1.6, 3);
    std::vector<double> f;
    for (const double v : a) f.push_back(-3.2 * v);
    const Record sut = preprocessed({rate_hz, a, f});
    for (std::size_t n = 0; n < sut.size(); ++n) {
      ASSERT_NEAR(sut.force_n[n], -3.2 * sut.acceleration_m_s2[n], 1e-12) << rate_hz;
    }
  }
}

TEST(PaperPreprocessingTest, AFractionalRateGivesTheSameSignal) {
  // 130 Hz through the windowed sinc against 1000 Hz through plain decimation; both delayed alike
  // below 10 Hz but for the anti-alias filter's own warping, so amplitudes are compared.
  for (const double f : {0.7, 2.0, 4.0, 8.0}) {
    const auto slow = sine(f, 130.0, 40.0);
    const auto fast = sine(f, 1000.0, 40.0);
    EXPECT_NEAR(amplitude(preprocessed({130.0, slow, slow}).force_n),
                amplitude(preprocessed({1000.0, fast, fast}).force_n), 1e-3)
        << f;
  }
}

TEST(PaperPreprocessingTest, UnusableRecordsAreRefused) {
  const std::vector<double> x(1000, 1.0);
  auto broken = x;
  broken[3] = INFINITY;
  EXPECT_THROW(preprocessed({99.0, x, x}), ConfigError);
  EXPECT_THROW(preprocessed({100.0, x, broken}), ConfigError);
  EXPECT_THROW(preprocessed({100.0, x, {1.0}}), ConfigError);
  EXPECT_THROW(preprocessed({2000.0, x, x}), ConfigError);
  EXPECT_NO_THROW(preprocessed({1000.0, x, x})) << "exactly a second";
  EXPECT_THROW(preprocessed({std::nan(""), x, x}), ConfigError);
}

}  // namespace
}  // namespace stillhand::identification::paper_preprocessing_test
