// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/core/residual_spectrum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stillhand::dashboard::residual_spectrum_test {

double sine(double amplitude, double frequency_hz, Tick tick) {
  return amplitude *
         std::sin(2.0 * std::numbers::pi * frequency_hz * static_cast<double>(tick) / 1000.0);
}

// Oracle: a sine of amplitude A holds A^2/2, wherever its line lies; the model takes the one of 2
// Hz away and leaves the one of 11 Hz.  Floats hold 7 digits; Hann's skirts beyond 0.2 to 50 Hz
// hold less than 1e-4 of a line at 2 Hz.
TEST(ResidualSpectrumTest, HoldsThePowerOfEachLineAndTheResidualWhatTheModelLeaves) {
  ForceRecord record;
  for (Tick tick = 0; tick < 30'000; ++tick) {
    const double predicted_n = sine(3.0, 2.0, tick);
    record.measured(tick, predicted_n + sine(0.5, 11.0, tick));
    record.predicted(tick, predicted_n);
  }
  const ResidualSpectrum sut = residual_spectrum(record);
  EXPECT_EQ(sut.segments, 8u);
  EXPECT_NEAR(sut.length_s, 20.42, 1e-9);
  EXPECT_NEAR(sut.force_rms_n, std::sqrt(4.5 + 0.125), 1e-3);
  EXPECT_NEAR(sut.residual_rms_n, std::sqrt(0.125), 1e-4);
  const auto peak = std::ranges::max_element(sut.residual_n2_hz) - sut.residual_n2_hz.begin();
  EXPECT_NEAR(sut.frequency_hz[static_cast<std::size_t>(peak)], 11.0, 1000.0 / 4096.0 / 2.0);
  EXPECT_GT(sut.frequency_hz.front(), 0.0);
  EXPECT_LE(sut.frequency_hz.back(), 50.0);
  EXPECT_EQ(sut.force_n2_hz.size(), sut.frequency_hz.size());
}

TEST(ResidualSpectrumTest, IsEmptyBeforeASegmentIsThere) {
  ForceRecord record;
  for (Tick tick = 0; tick < 4000; ++tick) {
    record.measured(tick, 1.0);
    record.predicted(tick, 1.0);
  }
  EXPECT_EQ(residual_spectrum(record).segments, 0u);
  EXPECT_EQ(residual_spectrum(ForceRecord{}).segments, 0u);
}

}  // namespace stillhand::dashboard::residual_spectrum_test
