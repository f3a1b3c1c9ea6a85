// SPDX-License-Identifier: Apache-2.0
// Low-pass and notch on the command: Eq. MI-1.
#include "services/core/cancellation/parts/command_shaping.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "services/core/contract/config_error.hpp"

namespace stillhand::cancellation::command_shaping_test {

using Kind = ShapingConfig::Kind;

// Steady amplitude and phase of a sine through the filter, after 20 s.
std::complex<double> response(const ShapingConfig& config, double frequency_hz) {
  CommandShaping sut(config);
  std::complex<double> sum = 0.0;
  constexpr int kSettle = 20'000;
  const int samples = static_cast<int>(std::lround(10.0 / frequency_hz)) * 1000;
  for (int n = 0; n < kSettle + samples; ++n) {
    const double phase = 2.0 * std::numbers::pi * frequency_hz * n * 1e-3;
    const double y = sut.step(std::sin(phase));
    if (n >= kSettle) sum += y * std::exp(std::complex<double>(0.0, -phase));
  }
  return sum * std::complex<double>(0.0, 2.0) / static_cast<double>(samples);
}

// Oracle: the analogue filter of Eq. MI-1.  Below 10 Hz the bilinear transform bends a frequency by
// less than (pi f/1000)^2/3 = 3.3e-4, which moves the response by less than 2e-3.
TEST(CommandShapingTest, FollowsItsAnalogueFilter) {
  for (const Kind kind : {Kind::kLowPass, Kind::kNotch}) {
    for (const double f : {0.2, 0.5, 1.0, 2.0, 5.0}) {
      const ShapingConfig config{kind, 1.25, 0.4};
      const std::complex<double> s(0.0, f / config.frequency_hz);
      const std::complex<double> den = s * s + 2.0 * config.damping_ratio * s + 1.0;
      const std::complex<double> expected = (kind == Kind::kNotch ? s * s + 1.0 : 1.0) / den;
      EXPECT_LT(std::abs(response(config, f) - expected), 2e-3) << "f = " << f;
    }
  }
}

TEST(CommandShapingTest, LeavesASteadyCommandAlone) {
  for (const Kind kind : {Kind::kLowPass, Kind::kNotch}) {
    CommandShaping sut({kind, 1.0, 0.5});
    double last = 0.0;
    for (int n = 0; n < 20'000; ++n) last = sut.step(0.3);
    EXPECT_NEAR(last, 0.3, 1e-9);
  }
}

// As if the stick had always been there.  Rounding: 1e-16 of the coefficients, which are up to 2,
// and the slowest filter keeps it for some 1e5 ticks.
TEST(CommandShapingTest, BeginsWithTheCommandAsItIs) {
  for (const Kind kind : {Kind::kLowPass, Kind::kNotch}) {
    for (const double f : {0.01, 1.0, 100.0}) {
      CommandShaping sut({kind, f, 0.7});
      for (int n = 0; n < 1000; ++n) ASSERT_NEAR(sut.step(0.3), 0.3, 1e-9);
      sut.restart();
      ASSERT_NEAR(sut.step(-0.2), -0.2, 1e-15);
    }
  }
}

TEST(CommandShapingTest, RefusesAFilterOutOfRange) {
  for (const auto& [f, z] : {std::pair{0.009, 0.7}, {101.0, 0.7}, {1.0, 0.04}, {1.0, 2.1}}) {
    EXPECT_THROW(CommandShaping({Kind::kNotch, f, z}), ConfigError) << f << " " << z;
  }
  for (const double z : {0.06, 1.9}) EXPECT_NO_THROW(CommandShaping({Kind::kLowPass, 1.0, z}));
}

}  // namespace stillhand::cancellation::command_shaping_test
