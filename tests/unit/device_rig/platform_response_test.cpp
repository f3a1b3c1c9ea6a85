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

TEST(PlatformTestTest, TheMotionKeepsItsLimitsAndBeginsAndEndsAtRest) {
  const PlatformTestLimits limits{.motion_m = 0.008};
  const PlatformTest sut(limits, 2);
  double most_m = 0.0;
  double before_m_s = 0.0;
  for (Tick tick = 0; tick < sut.ticks(); ++tick) {
    const auto each = sut.at(tick);
    most_m = std::max(most_m, std::abs(each.pos_m));
    // The fade adds a little to the multisine's own acceleration.
    EXPECT_LT(std::abs(each.vel_m_s - before_m_s) / kControlPeriod_s,
              1.2 * limits.max_acceleration_m_s2)
        << tick;
    before_m_s = each.vel_m_s;
  }
  EXPECT_LE(most_m, 1.0001 * limits.motion_m);
  EXPECT_GT(most_m, 0.2 * limits.motion_m);
  for (const Tick tick : {Tick{0}, sut.ticks() - 1}) {
    EXPECT_NEAR(sut.at(tick).pos_m, 0.0, 1e-12);
    EXPECT_NEAR(sut.at(tick).vel_m_s, 0.0, 1e-9);
  }
}

TEST(PlatformTestTest, EveryLineIsThatOfTheClosedForm) {
  const Simulated platform{.delay_ticks = 12, .b = 0.03};
  for (const PlatformLine& line : platform.identified().lines) {
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
  std::vector<PlatformResponse> all;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    all.push_back(
        Simulated{.delay_ticks = 5, .b = 0.03, .noise_m = 0.0004, .seed = seed}.identified({}, 6));
  }
  const auto scatter = [&](auto value) {
    double mean = 0.0, squares = 0.0;
    for (const auto& each : all) mean += value(each) / static_cast<double>(all.size());
    for (const auto& each : all) squares += (value(each) - mean) * (value(each) - mean);
    return std::sqrt(squares / static_cast<double>(all.size() - 1));
  };
  const auto stated = [&](auto error) {
    double mean = 0.0;
    for (const auto& each : all) mean += error(each) / static_cast<double>(all.size());
    return mean;
  };
  const double bandwidth = scatter([](const auto& r) { return r.bandwidth_hz; }) /
                           stated([](const auto& r) { return r.bandwidth_error_hz; });
  const double gain = scatter([](const auto& r) { return r.gain; }) /
                      stated([](const auto& r) { return r.gain_error; });
  // A scatter of 60 numbers is known to 9 %, the mean of errors from six periods is 5 % small.
  for (const double ratio : {bandwidth, gain}) {
    EXPECT_GT(ratio, 0.7);
    EXPECT_LT(ratio, 1.4);
  }
  // That of the lag also holds that the lag changes with frequency.
  EXPECT_LT(scatter([](const auto& r) { return r.lag_s; }),
            1.4 * stated([](const auto& r) { return r.lag_error_s; }));
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
