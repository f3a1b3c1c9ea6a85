// SPDX-License-Identifier: Apache-2.0
// The motor as spring, damper and mass: Eq. MI-2.
#include "services/core/cancellation/parts/stick_impedance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "services/core/contract/config_error.hpp"

namespace stillhand::cancellation::stick_impedance_test {

TEST(StickImpedanceTest, HoldsAgainstAStillStickByItsStiffness) {
  StickImpedance sut({.stiffness_n_m = 400.0});
  EXPECT_DOUBLE_EQ(sut.step(0.05, 0.0), -400.0 * 0.10 * 0.05);
}

TEST(StickImpedanceTest, OpposesSpeedByItsDamping) {
  StickImpedance sut({.damping_n_s_m = 20.0});
  EXPECT_DOUBLE_EQ(sut.step(0.3, 0.5), -20.0 * 0.10 * 0.5);
}

// Oracle: M s v behind 1/(1 + s/w10).  The lag is stepped by Euler, which is off by half a tick of
// its corner: pi 10 Hz 1 ms = 3 %.
TEST(StickImpedanceTest, OpposesAccelerationBehindItsLag) {
  constexpr double kFrequency_hz = 2.0;
  constexpr double kMass_kg = 0.5;
  StickImpedance sut({.mass_kg = kMass_kg});
  std::complex<double> sum = 0.0;
  constexpr int kSamples = 5000;
  for (int n = 0; n < 2 * kSamples; ++n) {
    const double phase = 2.0 * std::numbers::pi * kFrequency_hz * n * 1e-3;
    const double force = sut.step(0.0, std::sin(phase));
    if (n >= kSamples) sum += force * std::exp(std::complex<double>(0.0, -phase));
  }
  sum *= std::complex<double>(0.0, 2.0) / static_cast<double>(kSamples);
  const std::complex<double> s(0.0, 2.0 * std::numbers::pi * kFrequency_hz);
  const std::complex<double> expected =
      -kMass_kg * 0.10 * s / (1.0 + s / (2.0 * std::numbers::pi * kInertiaCorner_hz));
  EXPECT_LT(std::abs(sum - expected), 0.03 * std::abs(expected));
}

TEST(StickImpedanceTest, RefusesWhatGivesEnergy) {
  EXPECT_THROW(StickImpedance({.damping_n_s_m = -1.0}), ConfigError);
  EXPECT_THROW(StickImpedance({.stiffness_n_m = -1.0}), ConfigError);
  EXPECT_THROW(StickImpedance({.mass_kg = NAN}), ConfigError);
  EXPECT_THROW(StickImpedance({.lever_m = 0.0}), ConfigError);
}

}  // namespace stillhand::cancellation::stick_impedance_test
