// SPDX-License-Identifier: Apache-2.0
// Where the power of a signal lies, Eq. DG-65.
#include "services/core/diagnosis/record/excited_band.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

namespace stillhand::diagnosis::excited_band_test {

constexpr double kRate_hz = 100.0;
constexpr std::size_t kCount = 4096;  // whole periods of every line below: no leakage
constexpr double kLine_hz = kRate_hz / static_cast<double>(kCount);

// Sines at these lines, of amplitude 1 or `first` and 1, about 5.
std::vector<double> sines(const std::vector<int>& lines, double first = 1.0) {
  std::vector<double> x(kCount, 5.0);
  for (const int line : lines) {
    const double amplitude = line == lines.front() ? first : 1.0;
    for (std::size_t n = 0; n < kCount; ++n) {
      x[n] += amplitude * std::sin(2.0 * std::numbers::pi * line * static_cast<double>(n) / kCount);
    }
  }
  return x;
}

TEST(ExcitedBandTest, TheBandRunsFromTheLowestToTheHighestLine) {
  const ExcitedBand sut = excited_band("u", sines({40, 60, 80}), 5.0, kRate_hz);
  EXPECT_EQ(sut.of, "u");
  EXPECT_NEAR(sut.low_hz, 40 * kLine_hz, 1e-9);
  EXPECT_NEAR(sut.high_hz, 80 * kLine_hz, 1e-9);
  // A line of 1.5 % of the power counts, one of 0.8 % does not.
  for (const auto& [share, low, high] : {std::tuple{0.015, 20, 200}, {0.008, 60, 60}}) {
    const double amplitude = std::sqrt(share / (1.0 - share));
    EXPECT_NEAR(excited_band("u", sines({20, 60}, amplitude), 5.0, kRate_hz).low_hz, low * kLine_hz,
                1e-9);
    EXPECT_NEAR(excited_band("u", sines({200, 60}, amplitude), 5.0, kRate_hz).high_hz,
                high * kLine_hz, 1e-9);
  }
}

// One of three equal lines is outside.
TEST(ExcitedBandTest, PowerBelowAndAboveTheBandCounts) {
  const ExcitedBand sut = excited_band("u", sines({40, 80}), 5.0, kRate_hz);
  EXPECT_NEAR(power_outside(sut, sines({40, 60, 80}), 5.0, kRate_hz), 0.0, 1e-12);
  EXPECT_NEAR(power_outside(sut, sines({20, 60, 80}), 5.0, kRate_hz), 1.0 / 3.0, 1e-9);
  EXPECT_NEAR(power_outside(sut, sines({40, 60, 200}), 5.0, kRate_hz), 1.0 / 3.0, 1e-9);
}

TEST(ExcitedBandTest, AConstantHasNoPower) {
  const ExcitedBand sut = excited_band("u", sines({40}), 5.0, kRate_hz);
  EXPECT_EQ(power_outside(sut, std::vector<double>(kCount, 7.0), 7.0, kRate_hz), 0.0);
}

}  // namespace stillhand::diagnosis::excited_band_test
