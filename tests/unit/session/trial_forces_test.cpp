// SPDX-License-Identifier: Apache-2.0
// Eq. SN-4 to SN-6 on signals whose answers are known.
#include "apps/libraries/session/core/trial_forces.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stillhand::session::trial_forces_test {
namespace {

TEST(TrialForcesTest, TheMotorTakesAwayWhatItOpposes) {
  ForceSignals signals;
  for (int n = 0; n < 1000; ++n) {
    const double f = n % 2 == 0 ? 3.0 : -3.0;
    signals.feedthrough_n.push_back(f);
    signals.motor_n.push_back(-0.75 * f);
    signals.volitional_n.push_back(2.0);
    signals.hand_m_s.push_back(0.0);
  }
  const TrialForces sut = trial_forces(signals, 100.0);
  // 3 - 2.25; dyadic numbers, exact.
  EXPECT_EQ(sut.left_n, 0.75);
  EXPECT_EQ(sut.motor_n, 2.25);
  EXPECT_EQ(sut.volitional_n, 2.0);
  EXPECT_EQ(sut.acceleration_m_s2, 0.0);
}

TEST(TrialForcesTest, AccelerationIsTheSameAtBothRates) {
  constexpr double kHz = 2.0;
  constexpr double kSpeed_m_s = 0.1;
  const double w = 2.0 * std::numbers::pi * kHz;
  const auto at_rate = [&](double rate_hz) {
    ForceSignals signals;
    for (int n = 0; n < static_cast<int>(10.0 * rate_hz); ++n) {
      signals.hand_m_s.push_back(kSpeed_m_s * std::sin(w * n / rate_hz));
    }
    return trial_forces(signals, rate_hz).acceleration_m_s2;
  };
  EXPECT_NEAR(at_rate(1000.0), at_rate(100.0), 1e-9);
  // A mean over 10 ms takes (w T)^2 / 24 = 7e-4 of a 2 Hz sine; of 1000 intervals the last one,
  // at the largest acceleration, is missing: 5e-4.
  EXPECT_NEAR(at_rate(100.0), kSpeed_m_s * w / std::numbers::sqrt2, 1.2e-3);
}

TEST(TrialForcesTest, NothingHasNoForce) {
  EXPECT_EQ(rms({}), 0.0);
  const TrialForces sut = trial_forces({}, 100.0);
  EXPECT_EQ(sut.left_n, 0.0);
  EXPECT_EQ(sut.acceleration_m_s2, 0.0);
}

}  // namespace
}  // namespace stillhand::session::trial_forces_test
