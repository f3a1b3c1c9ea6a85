// SPDX-License-Identifier: Apache-2.0
#include "services/core/vehicle/vehicle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <iterator>
#include <limits>
#include <string>
#include <tuple>

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/signal/random.hpp"

namespace stillhand::vehicle::vehicle_test {
namespace {

using Complex = std::complex<double>;

VehicleInput stick(double theta_rad) { return {theta_rad, true, 1.0, 0.0, 0.0}; }

// Acceleration per stick angle by running: a sine of whole cycles, the last of which is correlated.
// The platform follows the command, as behind a guard that has nothing to shape.
Complex driven_response(const VehicleConfig& config, Tick period_ticks) {
  Vehicle sut(config);
  const Tick settle = period_ticks * (1 + 60'000 / period_ticks);
  VehicleMotion at;
  Complex in;
  Complex out;
  for (Tick n = 0; n < settle + period_ticks; ++n) {
    const double phase =
        kTwoPi * static_cast<double>(n % period_ticks) / static_cast<double>(period_ticks);
    VehicleInput input = stick(1e-4 * std::sin(phase));
    input.platform_position_m = at.position_m;
    input.platform_velocity_m_s = at.velocity_m_s;
    at = sut.step(input);
    if (n < settle) continue;
    in += input.theta_rad * std::polar(1.0, -phase);
    out += at.acceleration_m_s2 * std::polar(1.0, -phase);
  }
  return out / in;
}

// Eqs. VH-1 to VH-5.  The core leaves the 20 ticks of the lead to its caller, so the closed form is
// turned back by them.  First order is the recursion itself: rounding and the rest of the washout's
// transient, exp(-60 s 2 pi 0.05 Hz) = 7e-9.  A second-order lag takes the held input as half a
// tick: of its staircase (w dt)^2/24 is left, and of the sampled first integral (w dt)^2/12; both
// below 1e-4 at 5 Hz.
TEST(VehicleTest, TheResponseIsTheClosedForm) {
  for (const std::string& name : preset_names()) {
    const VehicleConfig config = preset(name);
    for (const Tick period : {2000, 500, 200}) {
      const double f = kControlRateHz / static_cast<double>(period);
      const double lead_s = static_cast<double>(kLead_ticks) * kControlPeriod_s;
      const Complex expected = vehicle_response(config, f) * std::polar(1.0, kTwoPi * f * lead_s);
      const double bound = config.order == 1 ? 1e-6 : 1e-3;
      EXPECT_LT(std::abs(driven_response(config, period) / expected - 1.0), bound)
          << name << " at " << f << " Hz";
    }
  }
}

// Eq. VH-4 in continuous time, behind a lag of 5 ms and the delay: a tick changes it by w dt of the
// highest rate, 2 pi 0.4 Hz 1 ms = 0.3 %.
TEST(VehicleTest, TheWashoutIsAThirdOrderHighPass) {
  VehicleConfig config;
  config.lag_s = 0.005;
  const double w = kTwoPi * 0.4;
  for (const double f : {0.03, 0.1, 0.4, 1.0}) {
    const Complex s{0.0, kTwoPi * f};
    const Complex washout = s * s * s / ((s * s + 2.0 * 0.7 * w * s + w * w) * (s + kTwoPi * 0.05));
    EXPECT_NEAR(std::abs(vehicle_response(config, f) / (3.0 * washout)), 1.0, 0.01) << f;
  }
}

// G is the largest |V| without the washout: at high frequency where the speed follows with one lag,
// at the natural frequency with two, at 0 Hz where the acceleration follows.
// Where the stick sets an acceleration, the gain is that at 0 Hz: the largest without a resonance.
TEST(VehicleTest, TheGainIsTheLargestResponse) {
  for (const std::string& name : preset_names()) {
    VehicleConfig config = preset(name);
    if (!config.speed_follows && config.order == 2) config.damping_ratio = 0.8;  // no resonance
    config.washout = {0.05, 0.7, 0.0};
    if (!config.speed_follows) config.lag_s = 0.05;
    double largest = 0.0;
    for (int k = 0; k <= 600; ++k) {
      const double f = 0.2 * std::pow(500.0, k / 600.0);
      largest = std::max(largest, std::abs(vehicle_response(config, f)));
    }
    EXPECT_NEAR(largest / config.gain_m_s2_rad, 1.0, 0.02)
        << name;  // lag at 0.2 Hz, speed at 100 Hz
  }
}

// A constant command: the washout ends with the platform in the middle, Eq. VH-4 with d0 > 0.
TEST(VehicleTest, AHeldStickLeavesThePlatformInTheMiddle) {
  VehicleConfig config;
  config.gain_m_s2_rad = 1.0;
  Vehicle sut(config);
  VehicleMotion at;
  double farthest = 0.0;
  for (Tick n = 0; n < 60'000; ++n) {
    VehicleInput input = stick(0.1);
    input.platform_position_m = at.position_m;
    input.platform_velocity_m_s = at.velocity_m_s;
    at = sut.step(input);
    farthest = std::max(farthest, std::abs(at.position_m));
  }
  EXPECT_GT(farthest, 1e-3);  // it moved
  EXPECT_LT(std::abs(at.position_m), 1e-6);
  EXPECT_LT(std::abs(at.acceleration_m_s2), 1e-6);
}

TEST(VehicleTest, NothingPassesTheBoundOfTheAcceleration) {
  signal::Gaussian normal(3, 0);
  for (const std::string& name : preset_names()) {
    VehicleConfig config = preset(name);
    config.gain_m_s2_rad = 100.0;
    Vehicle sut(config);
    for (int n = 0; n < 50'000; ++n) {
      VehicleInput input = stick(3.0 * normal());
      if (n % 17 == 0) input.theta_rad = std::numeric_limits<double>::quiet_NaN();
      if (n % 31 == 0) input.theta_rad = 1e308;
      input.sound = n % 5 != 0;
      input.share = n % 97 == 0 ? std::numeric_limits<double>::quiet_NaN() : 1.0;
      input.platform_position_m = 0.15 * std::sin(0.01 * n);
      input.platform_velocity_m_s = 1.2 * std::cos(0.013 * n);
      const VehicleMotion out = sut.step(input);
      ASSERT_LE(std::abs(out.acceleration_m_s2), config.max_acceleration_m_s2);
      ASSERT_EQ((out.flags & kSaturated) != 0u,
                std::abs(out.acceleration_m_s2) == config.max_acceleration_m_s2);
      ASSERT_TRUE(std::isfinite(out.position_m) && std::isfinite(out.velocity_m_s));
    }
  }
}

TEST(VehicleTest, ALostStickIsHeldAndThenCountsAsCentred) {
  VehicleConfig config;
  config.lag_s = 0.005;
  config.delay_s = 0.02;
  Vehicle sut(config);
  for (int n = 0; n < 100; ++n) sut.step(stick(0.1));
  const VehicleInput lost{.share = 1.0};
  for (std::int64_t n = 0; n < config.max_hold_ticks; ++n) {
    const VehicleMotion out = sut.step(lost);
    EXPECT_NEAR(out.acceleration_m_s2, 0.1 * config.gain_m_s2_rad, 1e-6);
    EXPECT_TRUE(out.flags & kInputStale);
  }
  for (int n = 0; n < 100; ++n) sut.step(lost);  // 20 lags: exp(-20) = 2e-9
  EXPECT_NEAR(sut.step(lost).acceleration_m_s2, 0.0, 1e-8);
}

// README, "Presets".
TEST(VehicleTest, APresetIsTheRowOfItsTable) {
  struct Row {
    const char* name;
    bool speed_follows;
    std::int64_t order;
    double lag_s, natural_hz, damping_ratio, delay_s;
  };
  const VehicleConfig d;  // of the dynamics that a row does not have
  const Row rows[]{{"first_order", false, 1, 0.2, d.natural_hz, d.damping_ratio, 0.1},
                   {"second_order", false, 2, d.lag_s, 2.0, 0.6, 0.1},
                   {"excavator", true, 2, d.lag_s, 1.5, 0.3, 0.15},
                   {"wheelchair", true, 1, 0.5, d.natural_hz, d.damping_ratio, 0.06},
                   {"aircraft_roll", true, 1, 0.4, d.natural_hz, d.damping_ratio, 0.1}};
  ASSERT_EQ(preset_names().size(), std::size(rows));
  for (const Row& row : rows) {
    const VehicleConfig sut = preset(row.name);
    EXPECT_EQ(std::tuple(sut.speed_follows, sut.order, sut.lag_s, sut.natural_hz, sut.damping_ratio,
                         sut.delay_s),
              std::tuple(row.speed_follows, row.order, row.lag_s, row.natural_hz, row.damping_ratio,
                         row.delay_s))
        << row.name;
  }
}

TEST(VehicleTest, AnUnknownPresetAndAFieldOutOfRangeAreNamed) {
  EXPECT_THROW(preset("bicycle"), ConfigError);
  VehicleConfig config;
  config.delay_s = 0.01;  // less than the lead
  EXPECT_THROW(Vehicle{config}, ConfigError);
}

}  // namespace
}  // namespace stillhand::vehicle::vehicle_test
