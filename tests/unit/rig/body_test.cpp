// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/parts/body.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "services/core/contract/units.hpp"
#include "services/core/rig/parts/body_response.hpp"

namespace stillhand::rig::body_test {
namespace {

constexpr double kDt_s = kControlPeriod_s;
constexpr int kSecond = 1000;

StickConfig frictionless() { return {.coulomb_friction_n = 0.0}; }

/// Sum of unit sinusoids at `frequencies_hz`, phases spread so that the peaks do not add up.
double multisine(const std::vector<double>& frequencies_hz, double t_s) {
  double sum = 0.0;
  for (std::size_t k = 0; k < frequencies_hz.size(); ++k) {
    const double order = static_cast<double>(k);
    sum += std::sin(kTwoPi * frequencies_hz[k] * t_s + 0.7 * order * order);
  }
  return sum;
}

/// Fourier coefficient at a frequency that fits the record a whole number of times.
std::complex<double> line(const std::vector<double>& samples, double frequency_hz) {
  std::complex<double> sum = 0.0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    sum += samples[n] * std::polar(1.0, -kTwoPi * frequency_hz * static_cast<double>(n) * kDt_s);
  }
  return sum;
}

const std::vector<double> kLines_hz = {0.2, 0.7, 1.3, 2.0, 2.9,  4.1,
                                       5.3, 6.1, 7.3, 8.9, 12.1, 19.9};

// The chain is exact but for the platform's acceleration, taken as linear between samples: a
// sinusoid loses a share (pi f dt)^2 / 3 of its amplitude that way.  Three times that, on the part
// of H that passes the chain (all but the masses above the load cell), leaves room for the images
// near 1 kHz.  Transients: slowest mode decays with 5 /s, so e^-50 is left after 10 s.
TEST(BodyTest, FeedthroughFollowsItsAnalyticFrequencyResponse) {
  const BodyConfig body{.arm_rest_stiffness_n_m = 300.0, .arm_rest_damping_n_s_m = 10.0};
  const StickConfig stick;
  for (const bool pegged : {true, false}) {
    Body sut(body, stick);
    std::vector<double> input;
    std::vector<double> output;
    for (int n = 0; n < 20 * kSecond; ++n) {
      const double a_m_s2 = multisine(kLines_hz, n * kDt_s);
      const auto out = sut.step({a_m_s2, 0.0, 0.0, pegged});
      if (n < 10 * kSecond) continue;
      input.push_back(a_m_s2);
      output.push_back(out.feedthrough_force_n);
    }
    for (const double f : kLines_hz) {
      const auto expected = feedthrough_response(body, stick, pegged, f);
      const auto measured = line(output, f) / line(input, f);
      const double through_chain = std::abs(expected + body.hand_mass_kg + stick.handle_mass_kg);
      const double bound = std::pow(std::numbers::pi * f * kDt_s, 2) * through_chain + 1e-9;
      EXPECT_LT(std::abs(measured - expected), bound) << f << " Hz, pegged " << pegged;
    }
  }
}

// The force is held over a tick, half a tick of delay on average: relative error pi f dt, and a
// second-order rest of its square.  Measured against the middle of the tick the half tick is gone.
TEST(BodyTest, StickFollowsTheHandAdmittance) {
  const BodyConfig body;
  auto stick = frictionless();
  stick.centring_stiffness_n_m = 150.0;
  Body sut(body, stick);
  std::vector<double> input;
  std::vector<double> output;
  for (int n = 0; n < 20 * kSecond; ++n) {
    const double force_n = multisine(kLines_hz, n * kDt_s);
    // Half is the person's own, half shakes the hand above the cell.
    const auto out = sut.step({0.0, 0.0, 0.5 * force_n, false, 0.5 * force_n});
    if (n < 10 * kSecond) continue;
    input.push_back(force_n);
    output.push_back(out.theta_rad * stick.lever_m);
  }
  for (const double f : kLines_hz) {
    const auto expected = hand_admittance(body, stick, false, f);
    const auto half_tick = std::polar(1.0, kTwoPi * f * 0.5 * kDt_s);
    const auto measured = line(output, f) / line(input, f) / half_tick;
    EXPECT_LT(std::abs(measured - expected),
              std::pow(std::numbers::pi * f * kDt_s, 2) * std::abs(expected) + 1e-12)
        << f << " Hz";
  }
}

double largest_theta_error_rad(const StickConfig& stick) {
  constexpr int kFiner = 10;
  Body sut(BodyConfig{}, stick);
  Body finer(BodyConfig{}, stick, kDt_s / kFiner);
  double largest = 0.0;
  for (int n = 0; n < 5 * kSecond; ++n) {
    const double force_n = 20.0 * std::sin(kTwoPi * 0.4 * n * kDt_s);
    const auto acceleration = [](double t_s) { return 2.0 * std::sin(kTwoPi * 3.0 * t_s); };
    const auto out = sut.step({acceleration(n * kDt_s), 0.0, force_n, false});
    Body::Output fine{};
    for (int k = 1; k <= kFiner; ++k) {
      const double t_s = (n - 1 + static_cast<double>(k) / kFiner) * kDt_s;
      fine = finer.step({acceleration(t_s), 0.0, force_n, false});
    }
    largest = std::max(largest, std::abs(out.theta_rad - fine.theta_rad));
  }
  return largest;
}

// Without friction only the interpolation of a_y is left: (w dt)^2 / 8 = 4.4e-5 of a 3 Hz input
// whose response is 2 m/s^2 * 4.5 kg * 1.5 mm/N = 13.5 mm, or 0.135 rad: 6e-6 rad.  The finer run
// starts within the tick before 0, where the coarse one assumes rest: twice that.
TEST(BodyTest, DiscretisationErrorIsThatOfTheInterpolatedInput) {
  EXPECT_LT(largest_theta_error_rad(frictionless()), 1.2e-5);
}

// Friction may change sign up to a tick late: a speed error of 2 F_c dt / M = 6e-4 m/s at each
// reversal, which the chain (35 rad/s, well damped) turns into 1.8e-5 m = 1.8e-4 rad at most.
TEST(BodyTest, DiscretisationErrorOfFrictionIsASmallPartOfAnEncoderCount) {
  const double error_rad = largest_theta_error_rad(StickConfig{});
  EXPECT_LT(error_rad, 1.8e-4);
  EXPECT_LT(error_rad, 0.2 * kTwoPi / 4096.0);
}

// No input, no friction: the exact step of a passive chain can't gain energy; 1e-12 is rounding.
TEST(BodyTest, EnergyNeverGrowsWithoutInput) {
  Body sut(BodyConfig{}, frictionless());
  for (int n = 0; n < 100; ++n) sut.step({5.0, 0.0, 10.0, false});
  sut.step({0.0, 0.0, 0.0, false});
  double before_j = sut.energy_j();
  const double start_j = before_j;
  ASSERT_GT(start_j, 0.01);
  for (int n = 0; n < 5 * kSecond; ++n) {
    sut.step({0.0, 0.0, 0.0, false});
    ASSERT_LE(sut.energy_j(), before_j + 1e-12 * start_j) << n;
    before_j = sut.energy_j();
  }
  EXPECT_LT(before_j, 1e-9 * start_j);
}

// Friction is implicit; in the one tick in which the stick turns round it may act along the part
// of the way already gone: F_c * a dt^2 / 2 with a = 50 N / 0.65 kg, 8e-6 J, is the most it gives.
TEST(BodyTest, FrictionTakesEnergyOut) {
  const StickConfig rough{.coulomb_friction_n = 2.0};
  Body sut(BodyConfig{}, rough);
  Body smooth(BodyConfig{}, frictionless());
  for (int n = 0; n < 200; ++n) {
    sut.step({0.0, 0.0, 20.0, false});
    smooth.step({0.0, 0.0, 20.0, false});
  }
  double before_j = sut.energy_j();
  for (int n = 0; n < 300; ++n) {
    sut.step({0.0, 0.0, 0.0, false});
    ASSERT_LE(sut.energy_j(), before_j + 8e-5) << n;
    before_j = sut.energy_j();
  }
  EXPECT_EQ(sut.step({0.0, 0.0, 0.0, false}).omega_rad_s, 0.0);
}

TEST(BodyTest, FrictionHoldsTheStickAgainstALesserForceAndLetsGoAtAGreater) {
  const StickConfig stick{.coulomb_friction_n = 0.2};
  Body held(BodyConfig{}, stick);
  Body moved(BodyConfig{}, stick);
  double held_rad = 0.0;
  double moved_rad = 0.0;
  for (int n = 0; n < kSecond; ++n) {
    held_rad = held.step({0.0, 0.0, 0.19, false}).theta_rad;
    moved_rad = moved.step({0.0, 0.0, 0.40, false}).theta_rad;
  }
  // 1e-9 rad: rounding of a force balance of 0.2 N at rest; against 1.3 mm/N * 0.2 N = 2.6e-3 rad.
  EXPECT_LT(std::abs(held_rad), 1e-9);
  EXPECT_GT(moved_rad, 1e-3);
}

TEST(BodyTest, AStickNeverPassesTheRubberOfItsStops) {
  const StickConfig stick;
  const double steel_rad = stick.stop_angle_rad + stick.stop_travel_m / stick.lever_m;
  Body sut(BodyConfig{}, stick);
  Flags flags = kGood;
  double leftmost_rad = 0.0;
  for (int n = 0; n < 4 * kSecond; ++n) {
    const double push_n = n < 2 * kSecond ? 85.0 : -85.0;  // motor and person, both at their limit
    const auto out = sut.step({15.0 * std::sin(0.02 * n), push_n - 60.0, 60.0, false});
    flags |= out.flags;
    leftmost_rad = std::min(leftmost_rad, out.theta_rad);
    ASSERT_LE(std::abs(out.theta_rad), steel_rad * (1.0 + 1e-12)) << n;
  }
  EXPECT_TRUE(flags & kAtStop);
  EXPECT_LT(leftmost_rad, -stick.stop_angle_rad);
}

// At rest against the stop: rubber force = push - body's spring; depth = force / k_s.
TEST(BodyTest, ASteadyPushSinksIntoTheRubberByForceOverStiffness) {
  const StickConfig stick = frictionless();
  const BodyConfig body;
  Body sut(body, stick);
  Body::Output out{};
  for (int n = 0; n < 5 * kSecond; ++n) out = sut.step({0.0, 0.0, 60.0, false});
  const double spring_n_m = 1.0 / std::abs(hand_admittance(body, stick, false, 0.0));
  const double stop_m = stick.stop_angle_rad * stick.lever_m;
  const double expected_m =
      (60.0 + stick.stop_stiffness_n_m * stop_m) / (stick.stop_stiffness_n_m + spring_n_m);
  EXPECT_NEAR(out.theta_rad * stick.lever_m, expected_m, 1e-9);
  EXPECT_NEAR(out.omega_rad_s, 0.0, 1e-9);
}

// Critically damped from rest at x0, RG-4: x0 (1 + t/tau) exp(-t/tau), which the held force of the
// peg meets to a tick, in which x falls by 1/(e tau) of x0 a second at most.  Acceleration x0 /
// tau^2 at most, 4 m/s^2 here, so the rate changes by 0.04 rad/s a tick; 1.5 times that for the
// force steps of the muscles that relax.
TEST(BodyTest, ThePegDrawsTheStickSmoothlyToExactlyZero) {
  const StickConfig stick = frictionless();
  Body sut(BodyConfig{}, stick);
  Body::Output out{};
  for (int n = 0; n < 3 * kSecond; ++n) out = sut.step({0.0, 0.0, 30.0, false});
  ASSERT_GT(out.theta_rad, 0.25);
  double before_rad = out.theta_rad;
  double before_rad_s = out.omega_rad_s;
  const double start_m = before_rad * stick.lever_m;
  const double jump_rad_s =
      1.5 * start_m / std::pow(stick.peg_seat_time_s, 2) * kDt_s / stick.lever_m;
  for (int n = 0; n < 2 * kSecond; ++n) {
    out = sut.step({0.0, 0.0, 0.0, true});
    ASSERT_LE(out.theta_rad, before_rad + 1e-12) << n;
    ASSERT_GE(out.theta_rad, -1e-6) << n;
    const double along = (n + 1) * kDt_s / stick.peg_seat_time_s;
    ASSERT_NEAR(out.theta_rad * stick.lever_m, start_m * (1.0 + along) * std::exp(-along),
                0.0037 * start_m);
    ASSERT_LT(std::abs(out.omega_rad_s - before_rad_s), jump_rad_s) << n;
    before_rad = out.theta_rad;
    before_rad_s = out.omega_rad_s;
  }
  EXPECT_EQ(out.theta_rad, 0.0);
  EXPECT_EQ(out.omega_rad_s, 0.0);
}

// With the person's own force on top, RG-5, and what shakes the hand above the cell, RG-22 to
// RG-24.
TEST(BodyTest, APeggedStickShowsTheFeedthroughOnItsLoadCell) {
  Body sut(BodyConfig{}, StickConfig{});
  Body plain(BodyConfig{}, StickConfig{});
  for (int n = 0; n < 5 * kSecond; ++n) {
    const double a_m_s2 = 2.0 * std::sin(0.01 * n);
    const auto out = sut.step({a_m_s2, 10.0, 5.0, true, 3.0});
    ASSERT_EQ(out.theta_rad, 0.0);
    ASSERT_EQ(out.hand_force_n, out.feedthrough_force_n + 5.0) << n;
    ASSERT_NEAR(out.feedthrough_force_n,
                plain.step({a_m_s2, 0.0, 0.0, true}).feedthrough_force_n + 3.0, 1e-12);
  }
}

// Newton below the load cell: m_d a_j = f_cell + everything that acts there.  Without friction,
// f_cell = m_d a_j - f_m + b v_j + k_c x_j; a_j by central difference, error (w dt)^2 / 6 = 1.4e-3
// of m_d a_j for the fastest mode (15 Hz).
TEST(BodyTest, TheLoadCellForceAcceleratesTheDriveInertia) {
  StickConfig stick = frictionless();
  stick.viscous_damping_n_s_m = 5.0;
  stick.centring_stiffness_n_m = 200.0;
  Body sut(BodyConfig{}, stick);
  std::vector<Body::Output> out;
  const auto motor_n = [](int n) { return 3.0 * std::sin(0.03 * n); };
  for (int n = 0; n < 3 * kSecond; ++n) {
    out.push_back(sut.step({2.0 * std::sin(0.02 * n), motor_n(n), 0.0, false}));
  }
  for (std::size_t n = kSecond; n + 1 < out.size(); ++n) {
    const double accel_m_s2 =
        (out[n + 1].omega_rad_s - out[n - 1].omega_rad_s) * stick.lever_m / (2.0 * kDt_s);
    // The motor force steps by up to 0.09 N at a tick's edge; the difference straddles one edge.
    const double held_n = 0.5 * (motor_n(static_cast<int>(n)) + motor_n(static_cast<int>(n) + 1));
    const double below_n =
        held_n - stick.lever_m * (5.0 * out[n].omega_rad_s + 200.0 * out[n].theta_rad);
    ASSERT_NEAR(out[n].hand_force_n, stick.drive_mass_kg * accel_m_s2 - below_n, 0.05) << n;
  }
}

TEST(BodyTest, RefusesAStickWithoutMass) {
  const StickConfig stick{.drive_mass_kg = 0.0};
  EXPECT_THROW(Body(BodyConfig{}, stick), ConfigError);
}

// Eq. RG-28: a level is the body with k_a, k_h times exp(0.02 L) and c_a, c_h times its root, where
// RG-27, RG-28 or RG-40 alone can change it.
TEST(BodyTest, AStiffnessLevelIsTheBodyWithThatStiffness) {
  constexpr int kLevel = 20;
  BodyConfig stiff;
  const double factor = std::exp(StiffnessLevels::kStep * kLevel);
  stiff.shoulder_stiffness_n_m *= factor;
  stiff.grip_stiffness_n_m *= factor;
  stiff.shoulder_damping_n_s_m *= std::sqrt(factor);
  stiff.grip_damping_n_s_m *= std::sqrt(factor);
  for (const NeuromuscularConfig& hand : {NeuromuscularConfig{.stiffening_by_vibration_s2_m = -0.1},
                                          {.stiffening_by_motor_n = 0.1},
                                          {.wander = 0.1},
                                          {.change = 0.6}}) {
    Body sut(BodyConfig{.neuromuscular = hand}, StickConfig{});
    Body same(stiff, StickConfig{});
    for (int n = 0; n < 4 * kSecond; ++n) {
      const double a_m_s2 = 3.0 * std::sin(kTwoPi * 2.0 * n * kDt_s);
      const bool pegged = n < kSecond;
      const auto out = sut.step({a_m_s2, 0.0, 0.0, pegged, 0.0, kLevel});
      const auto expected = same.step({a_m_s2, 0.0, 0.0, pegged});
      // Rounding of the factors: a few ulp of 20 N.
      ASSERT_NEAR(out.feedthrough_force_n, expected.feedthrough_force_n, 1e-10) << n;
      ASSERT_NEAR(out.theta_rad, expected.theta_rad, 1e-12) << n;
    }
  }
}

// Eq. RG-29 at rest: a constant force on a held stick meets the shoulder's k_a + k_r in place of
// k_a; the force on the stick is then that of a body with the stiffer shoulder.
TEST(BodyTest, AReflexStiffensTheShoulderAtRest) {
  BodyConfig with;
  with.neuromuscular.reflex_stiffness_n_m = 200.0;
  BodyConfig stiff;
  // Co-contraction multiplies k_a, and not the reflex.
  stiff.shoulder_stiffness_n_m += 200.0 / stiff.cocontraction_stiffness_factor;
  Body sut(with, StickConfig{});
  Body expected(stiff, StickConfig{});
  Body without(BodyConfig{}, StickConfig{});
  double force_n = 0.0;
  double stiff_n = 0.0;
  double plain_n = 0.0;
  for (int n = 0; n < 20 * kSecond; ++n) {
    force_n = sut.step({1.0, 0.0, 0.0, false}).feedthrough_force_n;
    stiff_n = expected.step({1.0, 0.0, 0.0, false}).feedthrough_force_n;
    plain_n = without.step({1.0, 0.0, 0.0, false}).feedthrough_force_n;
  }
  EXPECT_NEAR(force_n, stiff_n, 1e-6 * std::abs(stiff_n));
  EXPECT_GT(std::abs(force_n - plain_n), 1e-3 * std::abs(plain_n));
}

}  // namespace
}  // namespace stillhand::rig::body_test
