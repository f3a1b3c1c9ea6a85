// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/sampling.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

#include "services/core/cancellation/parts/countermeasure.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/units.hpp"

namespace stillhand::cancellation::sampling_test {
namespace {

Countermeasure with_gain(const Config& config, double gain_n_s2_m) {
  Countermeasure sut(config, {.force = true});
  const signal::DifferenceModel gain{config.sampling.model_rate_hz(), {gain_n_s2_m}, {1.0}};
  EXPECT_EQ(sut.load_model(control_model(gain)), Refusal::kNone);
  return sut;
}

CountermeasureOutput step(Countermeasure& sut, Tick tick, double accel_m_s2) {
  return sut.step({tick, {0.0, accel_m_s2, 9.81, 0.0, 0.0, 0.0}, kGood, true, true, {}});
}

// [s] Delay of the force behind a sinusoid of the acceleration, by projection on its line.
double measured_delay_s(const Config& config, double frequency_hz) {
  Countermeasure sut = with_gain(config, 2.0);
  const Tick period = static_cast<Tick>(kControlRateHz / frequency_hz);
  std::complex<double> line;
  for (Tick n = 0; n < 20 * period; ++n) {
    const double turn = kTwoPi * frequency_hz * static_cast<double>(n) * kControlPeriod_s;
    const double force_n = step(sut, n, std::sin(turn)).predicted_force_n;
    if (n >= 10 * period) line += force_n * std::polar(1.0, -turn);
  }
  // sin(w (t - d)) has the line -j/2 exp(-j w d).
  const double lag = -std::arg(line * std::complex<double>(0.0, 1.0));
  return lag / (kTwoPi * frequency_hz);
}

TEST(SamplingTest, NowIsOnTimeAndPaperIsLateByItsChain) {
  Config config;
  EXPECT_NEAR(measured_delay_s(config, 0.5), 0.0, 1e-9);
  config.sampling = sampling_named("paper");
  // Eq. CC-16.  The hold repeats a force for 20 ticks, 0 to 19 ticks old: 9.5 ms in the mean.
  // Group delay of the prototype: sum over its poles of -Re 1/s_k, at 10 Hz.
  double low_pass_s = 0.0;
  for (int k = 0; k < 5; ++k) {
    const auto pole = std::polar(1.0, std::numbers::pi * (2 * k + 6) / 10.0);
    low_pass_s -= (1.0 / pole).real() / (kTwoPi * 10.0);
  }
  EXPECT_NEAR(low_pass_s, 0.0515, 1e-4);
  EXPECT_NEAR(measured_delay_s(config, 0.5), low_pass_s + 0.020 + 0.0095, 3e-4);
}

TEST(SamplingTest, EachStageIsASetting) {
  Config config;
  config.sampling.model_ticks = 20;
  EXPECT_NEAR(measured_delay_s(config, 0.5), 0.0095, 1e-4);
  config.sampling.latency_samples = 3;
  EXPECT_NEAR(measured_delay_s(config, 0.5), 0.0695, 1e-4);
  config.sampling = {};
  config.sampling.latency_samples = 5;
  EXPECT_NEAR(measured_delay_s(config, 0.5), 0.005, 1e-4);
}

TEST(SamplingTest, BetweenTwoSamplesTheForceIsHeld) {
  Config config;
  config.sampling.model_ticks = 20;
  Countermeasure sut = with_gain(config, 1.0);
  double held_n = 0.0;
  for (Tick n = 0; n < 2000; ++n) {
    const double force_n = step(sut, n, 1e-3 * static_cast<double>(n)).predicted_force_n;
    if (n % 20 == 0) held_n = force_n;
    if (n > 1000) {
      ASSERT_DOUBLE_EQ(force_n, held_n) << n;
    }
  }
  EXPECT_NEAR(held_n, 1.98, 1e-12);
}

// A model of another rate would be right in form and wrong in every frequency.
TEST(SamplingTest, AModelOfAnotherRateIsRefused) {
  Config config;
  config.sampling = sampling_named("paper");
  Countermeasure sut(config, {.force = true});
  const signal::DifferenceModel slow{50.0, {1.0}, {1.0}};
  const signal::DifferenceModel fast{1000.0, {1.0}, {1.0}};
  EXPECT_EQ(sut.load_model(control_model(fast)), Refusal::kWrongRate);
  EXPECT_EQ(sut.load_model(control_model(slow)), Refusal::kNone);
  ControlModel richer = control_model(slow);
  richer.paths.push_back({Channel::kAccelX, 0.1, {}, 1.0});
  EXPECT_EQ(sut.load_model(richer), Refusal::kWrongRate);
  Countermeasure now({}, {.force = true});
  EXPECT_EQ(now.load_model(control_model(slow)), Refusal::kWrongRate);
}

// The low-pass keeps nothing of a sample that is no motion, and starts again from rest with the
// filter.
TEST(SamplingTest, AnUnsoundSampleNeverReachesTheLowPass) {
  Config config;
  config.sampling = sampling_named("paper");
  Countermeasure sut = with_gain(config, 1.0);
  for (Tick n = 0; n < 3000; ++n) step(sut, n, 1.0);
  step(sut, 3000, std::numeric_limits<double>::quiet_NaN());
  step(sut, 3001, 1e9);
  for (Tick n = 3002; n < 6000; ++n) {
    ASSERT_TRUE(std::isfinite(step(sut, n, 1.0).force_n));
  }
  EXPECT_NEAR(step(sut, 6000, 1.0).predicted_force_n, 1.0, 1e-9);
}

TEST(SamplingTest, SettingsOutOfRangeAndUnknownNamesAreRefused) {
  EXPECT_THROW(sampling_named("later"), ConfigError);
  Config config;
  config.sampling.latency_samples = kMostLatency_samples + 1;
  EXPECT_THROW(Countermeasure(config, {.force = true}), ConfigError);
  config.sampling = {};
  config.sampling.model_ticks = 0;
  EXPECT_THROW(Countermeasure(config, {.force = true}), ConfigError);
}

}  // namespace
}  // namespace stillhand::cancellation::sampling_test
