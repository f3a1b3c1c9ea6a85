// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/parts/band_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "services/core/contract/tick.hpp"

namespace stillhand::rig::band_noise_test {

// y = R h * n / |h|: the filtered noise over the root of the mean of |H|^2 up to 500 Hz (Parseval),
// |H|^2 of a Butterworth of order 4 at each edge, 1/(1 + (tan/tan)^8) after the bilinear transform.
TEST(BandNoiseTest, IsFilteredNoiseOfItsRms) {
  constexpr BandNoise::Band kBand{0.5, 15.0, 0.3};
  const auto warped = [](double hz) { return std::tan(std::numbers::pi * hz / kControlRateHz); };
  double mean = 0.0;
  constexpr int kPoints = 100'000;
  for (int i = 0; i < kPoints; ++i) {
    const double w = warped((i + 0.5) * 500.0 / kPoints);
    mean += 1.0 / (1.0 + std::pow(warped(kBand.low_hz) / w, 8)) /
            (1.0 + std::pow(w / warped(kBand.high_hz), 8)) / kPoints;
  }
  BandNoise sut(7, 3, kBand);
  SensorNoise noise(7, 3);
  signal::Butterworth high_pass(4, kBand.low_hz, kControlRateHz, signal::Passband::kHigh);
  signal::Butterworth low_pass(4, kBand.high_hz, kControlRateHz);
  for (int n = 0; n < 3000; ++n) {
    const double expected = kBand.rms / std::sqrt(mean) * low_pass.step(high_pass.step(noise()));
    ASSERT_NEAR(sut.step(), expected, 1e-7) << n;  // the energy that is cut off: 5e-9
  }
}

}  // namespace stillhand::rig::band_noise_test
