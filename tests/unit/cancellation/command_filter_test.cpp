// SPDX-License-Identifier: Apache-2.0
// Eq. CC-5 against its statics and its frequency response.
#include "services/core/cancellation/parts/command_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"

namespace stillhand::cancellation::command_filter_test {
namespace {

// A force held still moves the command by f / (K r).  After 5 s the free oscillation,
// exp(-B/(2M) t) = exp(-3.44 t), is 3e-8 of it.
TEST(CommandFilterTest, AConstantForceMovesTheCommandByItsStaticDeflection) {
  const HandCompliance& config = kAverageHand;
  CommandFilter sut(config);
  double theta_rad = 0.0;
  EXPECT_EQ(sut.step(0.123, 0.0), 0.123);
  for (int n = 0; n < 5000; ++n) theta_rad = sut.step(0.2, 3.0);
  const double expected = 0.2 - 3.0 / config.stiffness_n_m / config.lever_m;
  EXPECT_NEAR(theta_rad, expected, 1e-7 * std::abs(expected - 0.2) + 1e-15);
}

// Oracle: 1 / (K - M w^2 + j B w) at 1.5 Hz.  The held input lags by half a tick, w dt / 2 = 0.5 %.
TEST(CommandFilterTest, AToneIsPredictedWithTheGainOfMassSpringAndDamper) {
  const HandCompliance& config = kAverageHand;
  CommandFilter sut(config);
  const double w = 2.0 * std::numbers::pi * 1.5;
  const double real = config.stiffness_n_m - config.mass_kg * w * w;
  const double imaginary = config.damping_n_s_m * w;
  const double expected_rad = 1.0 / std::hypot(real, imaginary) / config.lever_m;
  double largest_rad = 0.0;
  for (int n = 0; n < 10000; ++n) {
    const double taken = -sut.step(0.0, std::sin(w * n * kControlPeriod_s));
    if (n >= 8000) largest_rad = std::max(largest_rad, std::abs(taken));
  }
  EXPECT_NEAR(largest_rad, expected_rad, 0.001 * expected_rad);
}

TEST(CommandFilterTest, RefusesWhatIsNoMassOnASpring) {
  HandCompliance config = kAverageHand;
  config.stiffness_n_m = -1.0;
  EXPECT_THROW(CommandFilter{config}, ConfigError);
  config = kAverageHand;
  config.damping_n_s_m = 100.0;  // above critical
  EXPECT_THROW(CommandFilter{config}, ConfigError);
}

}  // namespace
}  // namespace stillhand::cancellation::command_filter_test
