// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/parts/body_response.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stillhand::rig::body_response_test {
namespace {

const BodyConfig kBody;
const StickConfig kStick;

double magnitude_db(double frequency_hz) {
  return 20.0 * std::log10(std::abs(feedthrough_response(kBody, kStick, true, frequency_hz)));
}

/// First local extremum of the magnitude above `from_hz`, searched in steps of 10 mHz.
double extremum_hz(double from_hz, double sign) {
  for (double f = from_hz + 0.01; f < 40.0; f += 0.01) {
    const double here = sign * magnitude_db(f);
    if (here > sign * magnitude_db(f - 0.01) && here >= sign * magnitude_db(f + 0.01)) return f;
  }
  return 0.0;
}

// Paper IV-A: "if one uses 10dB to approximate the magnitude at low frequencies"; +-1.5 dB is the
// spread that the twelve models of Fig. 6 leave around it.
TEST(BodyResponseTest, IsAboutTenDecibelsAtZeroFrequency) {
  EXPECT_NEAR(magnitude_db(0.0), 10.0, 1.5);
}

// Paper III-A: "two peaks separated by a notch at about 6 Hz"; IV-A: "a notch in magnitude between
// 5 and 8 Hz followed by a small peak".
TEST(BodyResponseTest, HasANotchBetweenFiveAndEightHertzWithASmallPeakAfterIt) {
  const double first_peak_hz = extremum_hz(0.5, 1.0);
  const double notch_hz = extremum_hz(first_peak_hz, -1.0);
  const double second_peak_hz = extremum_hz(notch_hz, 1.0);
  EXPECT_LT(first_peak_hz, 5.0);
  EXPECT_GT(notch_hz, 5.0);
  EXPECT_LT(notch_hz, 8.0);
  EXPECT_GT(second_peak_hz, notch_hz);
  EXPECT_LT(second_peak_hz, 10.0);  // inside the band that the paper fits
  EXPECT_GT(magnitude_db(second_peak_hz), magnitude_db(notch_hz) + 1.0);  // visible
  EXPECT_LT(magnitude_db(second_peak_hz), magnitude_db(0.0));             // small
}

// Zero relative degree: at high frequency the arm stays behind (x_a = a / w^2) and -(m_h + m_g)
// remains.  The grip adds k_h / w^2 = 6e-5 kg and, in quadrature, c_h / w = 1.9e-3 kg at 1 kHz.
TEST(BodyResponseTest, HasAPhaseOf180DegreesAtBothEnds) {
  EXPECT_EQ(feedthrough_response(kBody, kStick, true, 0.0).imag(), 0.0);
  EXPECT_LT(feedthrough_response(kBody, kStick, true, 0.0).real(), 0.0);
  const auto high = feedthrough_response(kBody, kStick, true, 1000.0);
  EXPECT_NEAR(high.real(), -(kBody.hand_mass_kg + kStick.handle_mass_kg), 2e-4);
  EXPECT_LT(std::abs(high.imag()), 4e-3);
}

// Statics: under a constant acceleration the trunk moves by (m_t a + pull) / k_t; written out by
// hand for springs in series, without the dynamic-stiffness matrix of the implementation.  The arm
// rest and the stick's centring are springs in parallel.
TEST(BodyResponseTest, EqualsTheStaticSolutionAtZeroFrequency) {
  const BodyConfig rested{.arm_rest_stiffness_n_m = 300.0};
  const StickConfig centred{.centring_stiffness_n_m = 150.0};
  const double k_t = kBody.seat_stiffness_n_m;
  const double k_a = kBody.shoulder_stiffness_n_m;
  const double k_h = kBody.grip_stiffness_n_m;
  const double upstream_n_m = 1.0 / (1.0 / k_t + 1.0 / k_a);
  // Thevenin: what the arm would move freely, then divided between upstream springs and grip.
  const double free_arm_m = -kBody.trunk_mass_kg / k_t - kBody.arm_mass_kg / upstream_n_m;
  const double grip_n = k_h * free_arm_m * upstream_n_m / (upstream_n_m + 300.0 + k_h);
  const double expected = grip_n - kBody.hand_mass_kg - kStick.handle_mass_kg;
  EXPECT_NEAR(feedthrough_response(rested, kStick, true, 0.0).real(), expected, 1e-12);
  const double arm_n_m = 1.0 / (1.0 / k_h + 1.0 / (upstream_n_m + 300.0));
  EXPECT_NEAR(std::abs(hand_admittance(rested, centred, true, 0.0)), 1.0 / (arm_n_m + 150.0),
              1e-15);
}

// Far above the modes only the stick's mass moves: 1/(M w^2); k_h / (M w^2) = 1e-5 at 3 kHz, and
// the damping terms (b + c_h)/(M w) = 1e-3 in quadrature.
TEST(BodyResponseTest, HandAdmittanceIsThatOfTheMassAtHighFrequency) {
  const double mass_kg = kBody.hand_mass_kg + kStick.handle_mass_kg + kStick.drive_mass_kg;
  const double omega_rad_s = 2.0 * std::numbers::pi * 3000.0;
  const auto admittance = hand_admittance(kBody, kStick, true, 3000.0);
  EXPECT_NEAR(admittance.real() * -mass_kg * omega_rad_s * omega_rad_s, 1.0, 1e-4);
}

TEST(BodyResponseTest, ATrackingHandIsStifferThanAnIdleOne) {
  EXPECT_LT(std::abs(hand_admittance(kBody, kStick, false, 0.0)),
            std::abs(hand_admittance(kBody, kStick, true, 0.0)));
}

// A passive chain can't give energy away: the velocity per force at the hand has a positive real
// part at every frequency.
TEST(BodyResponseTest, DrivingPointMobilityIsPositiveReal) {
  for (double f = 0.05; f < 200.0; f *= 1.05) {
    for (const bool relaxed : {true, false}) {
      const std::complex<double> s(0.0, 2.0 * std::numbers::pi * f);
      ASSERT_GT((s * hand_admittance(kBody, kStick, relaxed, f)).real(), 0.0) << f << " Hz";
    }
  }
}

}  // namespace
}  // namespace stillhand::rig::body_response_test
