// SPDX-License-Identifier: Apache-2.0
// The rig's sensors and the conditioner's calibration undo each other.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "services/core/contract/units.hpp"
#include "services/core/rig/parts/body_response.hpp"
#include "services/core/rig/rig.hpp"
#include "services/core/sensing/conditioner.hpp"
#include "services/core/signal/butterworth.hpp"

namespace stillhand::sensing::round_trip_test {
namespace {

DeviceSample device_sample(Tick tick, const rig::RawSample& raw) {
  return {tick,          raw.accel_x_v,   raw.accel_y_v,
          raw.accel_z_v, raw.load_cell_v, raw.encoder_counts,
          raw.roll_rad};
}

/// Drives the rig with a 1 Hz motion and a person at 0.4 Hz.
rig::RigInput motion(Tick tick, bool pegged) {
  const double t_s = static_cast<double>(tick) * kControlPeriod_s;
  rig::RigInput input;
  input.command_valid = true;
  input.command_position_m = 0.03 * std::sin(kTwoPi * t_s);
  input.command_velocity_m_s = 0.03 * kTwoPi * std::cos(kTwoPi * t_s);
  input.command_acceleration_m_s2 = -0.03 * kTwoPi * kTwoPi * std::sin(kTwoPi * t_s);
  input.operator_valid = !pegged;
  input.operator_force_n = 15.0 * std::sin(kTwoPi * 0.4 * t_s);
  input.pegged = pegged;
  return input;
}

struct Errors {
  double accel_rms_m_s2 = 0.0, force_rms_n = 0.0, theta_max_rad = 0.0, omega_rms_rad_s = 0.0;
};

/// Sensed minus truth, the truth through the same filter as the sensed acceleration and force, and
/// the true rate through the rate filter and the half tick of a difference.
Errors round_trip(int ticks) {
  rig::Rig rig{rig::RigConfig{}};
  Conditioner sut{Config{}};
  signal::Butterworth accel_filter(2, 200.0, kControlRateHz);
  signal::Butterworth force_filter(2, 200.0, kControlRateHz);
  signal::Butterworth rate_filter(2, 30.0, kControlRateHz);
  Errors errors;
  double theta_before_rad = 0.0;
  int counted = 0;
  for (int n = 0; n < ticks; ++n) {
    const auto out = rig.step(motion(n, false));
    const auto sensed = sut.step(device_sample(n, out.raw));
    const double accel = accel_filter.step(out.truth.platform_acceleration_m_s2);
    const double force = force_filter.step(out.truth.hand_force_n);
    const double omega =
        rate_filter.step((out.truth.theta_rad - theta_before_rad) / kControlPeriod_s);
    theta_before_rad = out.truth.theta_rad;
    if (n < 1000) continue;
    ++counted;
    errors.accel_rms_m_s2 += std::pow(sensed.accel_y_m_s2 - accel, 2);
    errors.force_rms_n += std::pow(sensed.force_n - force, 2);
    errors.omega_rms_rad_s += std::pow(sensed.omega_rad_s - omega, 2);
    errors.theta_max_rad =
        std::max(errors.theta_max_rad, std::abs(sensed.theta_rad - out.truth.theta_rad));
  }
  errors.accel_rms_m_s2 = std::sqrt(errors.accel_rms_m_s2 / counted);
  errors.force_rms_n = std::sqrt(errors.force_rms_n / counted);
  errors.omega_rms_rad_s = std::sqrt(errors.omega_rms_rad_s / counted);
  return errors;
}

// White noise of density D over 500 Hz, passed by a second-order Butterworth at 200 Hz, whose noise
// bandwidth is 1.11 * 200 Hz in continuous time and, prewarped, a little less: D sqrt(222) at most,
// D sqrt(200 * 0.9) at least.  The board's rounding (0.9 mm/s^2, 0.9 mN RMS) adds in quadrature.
TEST(RoundTripTest, LeavesTheSensorsNoiseAndNothingElse) {
  const auto errors = round_trip(20000);
  EXPECT_LT(errors.accel_rms_m_s2, std::hypot(1.08e-3 * std::sqrt(222.0), 0.9e-3));
  EXPECT_GT(errors.accel_rms_m_s2, 1.08e-3 * std::sqrt(180.0));
  EXPECT_LT(errors.force_rms_n, std::hypot(1.0e-3 * std::sqrt(222.0), 0.9e-3));
  EXPECT_GT(errors.force_rms_n, 1.0e-3 * std::sqrt(180.0));
}

// Half a count; the difference of two rounding errors, each uniform over a count q and at worst
// unrelated from tick to tick, has a variance of q^2/6, spread over 500 Hz with its weight at the
// top: below 30 Hz less than 1.11 * 30 / 500 of it remains.
TEST(RoundTripTest, LeavesTheEncodersRoundingOnAngleAndRate) {
  const auto errors = round_trip(20000);
  const double count_rad = kTwoPi / 4096.0;
  EXPECT_LE(errors.theta_max_rad, 0.5 * count_rad * (1.0 + 1e-9));
  EXPECT_LT(errors.omega_rms_rad_s,
            count_rad / kControlPeriod_s / std::sqrt(6.0) * std::sqrt(33.3 / 500.0));
}

// What identification will see in a pegged trial: force over acceleration at the excited line is
// H(jw) of the body.  Noise of 16 mN on 3 N over 10,000 samples: 16e-3 * sqrt(2/1e4) / 3.7 N = 6e-5
// of H for each signal; five times their sum.
TEST(RoundTripTest, KeepsTheFeedthroughOfAPeggedTrial) {
  rig::RigConfig config;
  config.body.neuromuscular = {};
  rig::Rig rig(config);
  Conditioner sut{Config{}};
  std::complex<double> accel = 0.0;
  std::complex<double> force = 0.0;
  for (Tick n = 0; n < 15000; ++n) {
    const auto out = rig.step(motion(n, true));
    const auto sensed = sut.step(device_sample(n, out.raw));
    if (n < 5000) continue;
    const auto turn = std::polar(1.0, -kTwoPi * static_cast<double>(n) * kControlPeriod_s);
    accel += sensed.accel_y_m_s2 * turn;
    force += sensed.force_n * turn;
  }
  const auto expected = rig::feedthrough_response(config.body, config.stick, true, 1.0);
  EXPECT_LT(std::abs(force / accel - expected), 6e-4 * std::abs(expected));
}

}  // namespace
}  // namespace stillhand::sensing::round_trip_test
