// SPDX-License-Identifier: Apache-2.0
// The motor as spring, damper and mass: Eq. MI-2.
#include "services/core/cancellation/parts/stick_impedance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <numbers>

#include "services/core/cancellation/parts/part_step.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/signal/butterworth.hpp"
#include "services/core/signal/force_envelope.hpp"

namespace stillhand::cancellation::stick_impedance_test {

TEST(StickImpedanceTest, HoldsAStillStickByItsStiffnessAndOpposesSpeedByItsDamping) {
  EXPECT_DOUBLE_EQ(StickImpedance({.stiffness_n_m = 200.0}).step(0.05, 0.0), -200.0 * 0.10 * 0.05);
  EXPECT_DOUBLE_EQ(StickImpedance({.damping_n_s_m = 20.0}).step(0.3, 0.5), -20.0 * 0.10 * 0.5);
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
  EXPECT_THROW(StickImpedance({.mass_kg = -0.1}), ConfigError);
  EXPECT_THROW(StickImpedance({.mass_kg = 0.9}), ConfigError);
  // K tau beyond what stick and part damp, tau = 2 ms.
  EXPECT_THROW(StickImpedance({.stiffness_n_m = 260.0}), ConfigError);
  EXPECT_NO_THROW(StickImpedance({.stiffness_n_m = 240.0}));
  EXPECT_NO_THROW(StickImpedance({.damping_n_s_m = 1.0, .stiffness_n_m = 740.0}));
  EXPECT_THROW(StickImpedance({.lever_m = 0.0}), ConfigError);
}

// A stick of 0.25 kg and 0.5 N s/m that somebody has let go, off its middle and moving, behind the
// steps of the encoder, the rate filter of 30 Hz, the force envelope and the motor's lag of 1.5 ms.
struct FreeStick {
  FreeStick(double stiffness_n_m, double damping_n_s_m, double most_n)
      : part(make_impedance({PartKind::kImpedance, {stiffness_n_m, damping_n_s_m, 0.0}})),
        envelope({.max_force_n = most_n}) {}

  // Runs for so long, pushed by a force from outside [N]; returns the largest motor force [N] of
  // the last second.
  template <typename Push>
  double largest_n(double seconds, Push push) {
    constexpr double kMass_kg = 0.25, kDamping_n_s_m = 0.5, kLag_s = 0.0015;
    constexpr double kStep_rad = 2.0 * std::numbers::pi / 4096.0;
    double largest = 0.0;
    const auto ticks = static_cast<int>(1e3 * seconds);
    for (int n = 0; n < ticks; ++n, ++tick) {
      const double omega = rate.step(v_m_s / 0.10);
      const double theta = kStep_rad * std::round(x_m / 0.10 / kStep_rad);
      const double asked_n = part->force_n({0.0, theta, omega, 0.0, motor_n, tick, trial});
      const double wanted_n = envelope.step(asked_n, true).force_n;
      if (n >= ticks - 1000) largest = std::max(largest, std::abs(wanted_n));
      for (int i = 0; i < 10; ++i) {
        motor_n += 1e-4 / kLag_s * (wanted_n - motor_n);
        v_m_s += 1e-4 / kMass_kg * (motor_n + push(n) - kDamping_n_s_m * v_m_s);
        x_m += 1e-4 * v_m_s;
      }
    }
    return largest;
  }

  Trial trial{};
  std::unique_ptr<PartStep> part;
  signal::Butterworth rate{2, 30.0, kControlRateHz};
  signal::ForceEnvelope envelope;
  double x_m = 0.005, v_m_s = 0.1, motor_n = 0.0;
  Tick tick = 0;
};

double slow_push(int n) { return 2.0 * std::sin(2.0 * std::numbers::pi * 1.0 * n * 1e-3); }

TEST(StickImpedanceTest, AStickThatIsLetGoIsPushedNoMore) {
  for (const double most_n : {10.0, 25.0}) {
    for (const double from_m : {0.005, 0.05}) {
      FreeStick sut(0.0, 90.0, most_n);
      sut.x_m = from_m;
      EXPECT_EQ(sut.largest_n(4.0, [](int) { return 0.0; }), 0.0) << most_n << " " << from_m;
      // Nor when it is taken again.
      EXPECT_EQ(sut.largest_n(2.0, slow_push), 0.0);
    }
  }
}

// Another trial has another part.
TEST(StickImpedanceTest, APartOfItsOwnBeginsAfresh) {
  FreeStick sut(0.0, 90.0, 25.0);
  sut.largest_n(4.0, [](int) { return 0.0; });
  sut.part = make_impedance({PartKind::kImpedance, {0.0, 20.0, 0.0}});
  EXPECT_GT(sut.largest_n(2.0, slow_push), 1.0);
}

TEST(StickImpedanceTest, AStableDamperGoesOn) {
  FreeStick sut(100.0, 30.0, 25.0);
  sut.largest_n(4.0, [](int) { return 0.0; });
  EXPECT_GT(sut.largest_n(2.0, slow_push), 1.0);
}

}  // namespace stillhand::cancellation::stick_impedance_test
