// SPDX-License-Identifier: Apache-2.0
// Eq. DR-18, on platforms whose response is known in closed form.
#include "services/core/device_rig/platform_response.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "services/core/contract/config_error.hpp"
#include "services/core/signal/moments.hpp"

namespace stillhand::device_rig::platform_response_test {

using Complex = std::complex<double>;

/// A delay of whole ticks and a first-order lag: y[n] = y[n-1] + b (x[n-d] - y[n-1]).
struct Simulated {
  std::size_t delay_ticks = 0;
  double b = 1.0;
  double noise_m = 0.0;
  unsigned seed = 1;
  double seat_gain = std::numeric_limits<double>::quiet_NaN();

  [[nodiscard]] Complex response(double frequency_hz) const {
    const Complex z = std::polar(1.0, 2.0 * std::numbers::pi * frequency_hz * kControlPeriod_s);
    return b * std::pow(z, -static_cast<double>(delay_ticks)) / (1.0 - (1.0 - b) / z);
  }
  [[nodiscard]] PlatformResponse identified(const PlatformTestLimits& limits = {},
                                            std::int64_t periods = 3) const {
    PlatformTest sut(limits, periods);
    std::mt19937 dice(seed);
    std::normal_distribution<double> noise(0.0, 1.0);
    std::vector<double> states;
    double y = 0.0;
    for (Tick tick = 0; tick < sut.ticks(); ++tick) {
      const auto at = static_cast<std::size_t>(tick);
      const double x = at < delay_ticks ? 0.0 : sut.at(static_cast<Tick>(at - delay_ticks)).pos_m;
      y += b * (x - y);
      states.push_back(y);
      // The acceleration of the state before the last one, which lags a tick: too little to count.
      const double seat = at < 2 ? 0.0 : 1e6 * (y - 2.0 * states[at - 1] + states[at - 2]);
      sut.take(tick, y + noise_m * noise(dice), seat_gain * seat);
    }
    return sut.result();
  }
};

// Each limit in turn is the one that is reached.  A central difference over two ticks is right to
// (w dt)^2/6 of each line, 0.3 % of the fastest.
TEST(PlatformTestTest, TheMotionUsesItsLimitsAndBeginsAndEndsAtRest) {
  for (const PlatformTestLimits& limits :
       {PlatformTestLimits{.motion_m = 0.001}, {1.0, 0.02, 2.0}, {1.0, 10.0, 0.5}}) {
    const PlatformTest sut(limits, 2);
    ASSERT_EQ(sut.ticks(), 2000 + 3 * 2000 + 2000);
    double used = 0.0, most_m_s = 0.0, most_m_s2 = 0.0, off_m_s = 0.0, off_m_s2 = 0.0;
    for (Tick tick = 1; tick + 1 < sut.ticks(); ++tick) {
      const auto before = sut.at(tick - 1), now = sut.at(tick), next = sut.at(tick + 1);
      most_m_s = std::max(most_m_s, std::abs(now.vel_m_s));
      most_m_s2 = std::max(most_m_s2, std::abs(now.accel_m_s2));
      off_m_s = std::max(off_m_s, std::abs((next.pos_m - before.pos_m) / 0.002 - now.vel_m_s));
      off_m_s2 =
          std::max(off_m_s2, std::abs((next.vel_m_s - before.vel_m_s) / 0.002 - now.accel_m_s2));
      used = std::max({used, std::abs(now.pos_m) / limits.motion_m,
                       std::abs(now.vel_m_s) / limits.max_velocity_m_s,
                       std::abs(now.accel_m_s2) / limits.max_acceleration_m_s2});
    }
    EXPECT_NEAR(used, 1.0, 1e-9);
    EXPECT_LT(off_m_s, 0.003 * most_m_s);
    EXPECT_LT(off_m_s2, 0.003 * most_m_s2);
    for (const Tick tick : {Tick{0}, sut.ticks() - 1}) {
      EXPECT_NEAR(sut.at(tick).pos_m, 0.0, 1e-12);
      EXPECT_NEAR(sut.at(tick).vel_m_s, 0.0, 1e-9);
    }
    // a/(1 + (f/2 Hz)^2), each a Fourier sum over a period.
    const auto amplitude = [&](double f_hz) {
      Complex sum = 0.0;
      for (Tick n = 2000; n < 4000; ++n) {
        sum += sut.at(n).pos_m *
               std::polar(1.0, 2e-3 * std::numbers::pi * f_hz * static_cast<double>(n));
      }
      return std::abs(sum) * (1.0 + f_hz * f_hz / 4.0);
    };
    for (const double f_hz : {2.0, 20.0}) EXPECT_NEAR(amplitude(f_hz) / amplitude(0.5), 1.0, 1e-6);
  }
}

TEST(PlatformTestTest, EveryLineIsThatOfTheClosedForm) {
  const Simulated platform{.delay_ticks = 12, .b = 0.03};
  const std::vector<PlatformLine> lines = platform.identified().lines;
  ASSERT_EQ(lines.size(), 12u);
  EXPECT_DOUBLE_EQ(lines.front().frequency_hz, 0.5);
  EXPECT_DOUBLE_EQ(lines.back().frequency_hz, 20.0);
  for (const PlatformLine& line : lines) {
    EXPECT_NEAR(std::abs(line.response - platform.response(line.frequency_hz)), 0.0, 1e-6)
        << line.frequency_hz;
    EXPECT_LT(line.error, 1e-6);
  }
}

TEST(PlatformTestTest, ADelayIsTheLag) {
  const PlatformResponse sut = Simulated{.delay_ticks = 37}.identified();
  EXPECT_NEAR(sut.lag_s, 0.037, 1e-6);
  EXPECT_LT(sut.lag_error_s, 1e-6);
  EXPECT_NEAR(sut.gain, 1.0, 1e-9);
  EXPECT_FALSE(sut.bandwidth_seen);
}

TEST(PlatformTestTest, TheBandwidthIsWhereTheClosedFormHasIt) {
  // b = 0.03: 4.9 Hz, 0.12: 20.3 Hz, beyond the highest line.
  for (const double b : {0.01, 0.02, 0.03, 0.06}) {
    const Simulated platform{.b = b};
    double low_hz = 0.5, high_hz = 20.0;
    for (int i = 0; i < 50; ++i) {
      const double middle_hz = 0.5 * (low_hz + high_hz);
      const bool above = std::abs(platform.response(middle_hz)) >
                         std::abs(platform.response(0.5)) / std::numbers::sqrt2;
      (above ? low_hz : high_hz) = middle_hz;
    }
    const PlatformResponse sut = platform.identified();
    EXPECT_TRUE(sut.bandwidth_seen);
    // Straight lines in the logarithms between two lines of the test: at most 3 %.
    EXPECT_NEAR(sut.bandwidth_hz / low_hz, 1.0, 0.03) << b;
  }
  EXPECT_FALSE((Simulated{.b = 0.15}.identified().bandwidth_seen));
}

TEST(PlatformTestTest, StandardErrorsAreTheScatterOverRepeats) {
  std::vector<double> bandwidths_hz, lags_s;
  double stated_hz = 0.0, stated_s = 0.0;  // means
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const PlatformResponse each =
        Simulated{.delay_ticks = 5, .b = 0.03, .noise_m = 0.0004, .seed = seed}.identified({}, 6);
    bandwidths_hz.push_back(each.bandwidth_hz);
    lags_s.push_back(each.lag_s);
    stated_hz += each.bandwidth_error_hz / 60.0;
    stated_s += each.lag_error_s / 60.0;
  }
  // A scatter of 60 numbers is known to 9 %, the mean of errors from six periods is 5 % small.
  const double ratio = std::sqrt(signal::variance(bandwidths_hz)) / stated_hz;
  EXPECT_GT(ratio, 0.7);
  EXPECT_LT(ratio, 1.4);
  // That of the lag also holds that the lag changes with frequency.
  EXPECT_LT(std::sqrt(signal::variance(lags_s)), 1.4 * stated_s);
}

// Two periods with gains 1 and 1.2, whose accelerometer reads 0.8 and 1 of their acceleration: half
// the difference is the standard error, 0.1.  A phase's is that over sqrt 2 and the gain, the lag's
// over the root of sum w^2, too, with the lines of 0.5, 1, 1.5, 2, 3 and 4 Hz.
TEST(PlatformTestTest, StandardErrorsAreThoseOfTheMeanOverPeriods) {
  PlatformTest test({}, 2);
  for (Tick tick = 0; tick < test.ticks(); ++tick) {
    const double gain = tick < 6000 ? 1.0 : 1.2;
    const auto x = test.at(tick);
    test.take(tick, gain * x.pos_m, (tick < 6000 ? 0.8 : 1.0) * gain * x.accel_m_s2);
  }
  const PlatformResponse sut = test.result();
  EXPECT_NEAR(sut.gain, 1.1, 1e-9);
  EXPECT_NEAR(sut.gain_error, 0.1 / std::numbers::sqrt2, 1e-9);
  EXPECT_NEAR(sut.lag_error_s,
              0.1 / std::numbers::sqrt2 / 1.1 / (2.0 * std::numbers::pi * std::sqrt(32.5)), 1e-9);
  EXPECT_NEAR(sut.seat_gain, 0.9, 1e-9);
  EXPECT_NEAR(sut.seat_gain_error, 0.1, 1e-9);
}

TEST(PlatformTestTest, TheAccelerometersSignAndScaleShow) {
  EXPECT_NEAR((Simulated{.seat_gain = 1.0}.identified().seat_gain), 1.0, 0.01);
  EXPECT_NEAR((Simulated{.seat_gain = -0.5}.identified().seat_gain), -0.5, 0.01);
  EXPECT_FALSE(Simulated{}.identified().seat_seen);
}

TEST(PlatformTestTest, APlatformThatStandsOrIsSilentIsRefused) {
  PlatformTest still({}, 2);
  PlatformTest silent({}, 2);
  for (Tick tick = 0; tick < still.ticks(); ++tick) {
    still.take(tick, 0.0, 0.0);
    silent.take(tick, std::numeric_limits<double>::quiet_NaN(), 0.0);
  }
  EXPECT_THROW((void)still.result(), ConfigError);
  EXPECT_THROW((void)silent.result(), ConfigError);
  EXPECT_THROW(PlatformTest({.motion_m = 0.0}, 2), ConfigError);
  EXPECT_THROW(PlatformTest({}, 1), ConfigError);
}

}  // namespace stillhand::device_rig::platform_response_test
