// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/multisine.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::signal::multisine_test {
namespace {

constexpr std::int64_t kPeriod = 10'000;
constexpr double kRateHz = 1000.0;

Multisine three_tones() {
  return Multisine(kPeriod, kRateHz, {{7, 1.0, 0.3}, {19, 0.8, 2.0}, {40, 0.5, -1.0}});
}

std::string message_of(std::vector<Component> components) {
  return support::refusal([&] { Multisine(kPeriod, kRateHz, std::move(components)); });
}

// Oracle: central differences.  Error of dv/dt <= (w_max dt)^2 / 6 * sum A with w_max = 2 pi 4 Hz:
// (0.02513)^2 / 6 * 2.3 = 2.42e-4 m/s^2.  For v = dx/dt each amplitude is A/w: sum (w dt)^2/6 A/w
// <= w_max dt^2/6 sum A = 25.1e-6 / 6 * 2.3 = 9.7e-6 m/s.
TEST(MultisineTest, VelocityAndPositionAreTheIntegrals) {
  const auto sut = three_tones();
  for (std::int64_t n = 1; n < kPeriod; ++n) {
    const MotionSample before = sut.at(n - 1);
    const MotionSample after = sut.at(n + 1);
    ASSERT_NEAR((after.vel_m_s - before.vel_m_s) * kRateHz / 2.0, sut.at(n).accel_m_s2, 2.5e-4);
    ASSERT_NEAR((after.pos_m - before.pos_m) * kRateHz / 2.0, sut.at(n).vel_m_s, 1e-5) << n;
  }
}

TEST(MultisineTest, SamplesOnePeriodApartAreBitIdentical) {
  const auto sut = three_tones();
  for (std::int64_t n = 0; n < kPeriod; n += 37) {
    const MotionSample here = sut.at(n);
    const MotionSample later = sut.at(n + 1'000'000 * kPeriod);
    ASSERT_EQ(std::memcmp(&here, &later, sizeof here), 0) << "n = " << n;
  }
}

// Sines over whole periods are orthogonal: mean square = sum A^2 / 2, to rounding of 1e4 terms.
TEST(MultisineTest, MeanSquareIsHalfTheSumOfSquaredAmplitudes) {
  const auto sut = three_tones();
  double sum = 0.0;
  for (std::int64_t n = 0; n < kPeriod; ++n) sum += sut.at(n).accel_m_s2 * sut.at(n).accel_m_s2;
  EXPECT_NEAR(sum / kPeriod, (1.0 + 0.64 + 0.25) / 2.0, 1e-12);
}

TEST(MultisineTest, PhaseStaysExactAtTheLargestPeriodAndHarmonic) {
  // k n mod N with k = N/2 - 1 and n = N - 1 is N - k = N/2 + 1: half a turn and a little.
  const std::int64_t period = Multisine::kMaxPeriod;
  const std::int64_t k = period / 2 - 1;
  const Multisine sut(period, kRateHz, {{k, 1.0, 0.0}});
  const double turn = static_cast<double>(period / 2 + 1) / static_cast<double>(period);
  EXPECT_EQ(sut.at(period - 1).accel_m_s2, std::sin(2.0 * std::numbers::pi * turn));
}

TEST(MultisineTest, ABrokenBoundIsNamedWithItsComponent) {
  EXPECT_THAT(message_of({{1, 1.0, 0.0}, {5000, 1.0, 0.0}}),
              testing::HasSubstr("components[1].harmonic: got 5000, want 0 < k < 5000"));
  EXPECT_THAT(message_of({{0, 1.0, 0.0}}), testing::HasSubstr("components[0].harmonic"));
  EXPECT_THAT(message_of({{1, NAN, 0.0}}), testing::HasSubstr("components[0].amplitude_m_s2"));
  EXPECT_THAT(message_of({{1, 1.0, INFINITY}}), testing::HasSubstr("components[0].phase_rad"));
  EXPECT_EQ(message_of({{4999, 1.0, 0.0}}), "accepted");
  EXPECT_THROW(Multisine(3, kRateHz, {}), ConfigError);
  EXPECT_NO_THROW(Multisine(4, kRateHz, {{1, 1.0, 0.0}}));
  EXPECT_THROW(Multisine(kPeriod, 0.0, {}), ConfigError);
}

// Schroeder (1970): with equal amplitudes phi_k = -pi k (k-1) / K, k = 1 .. K.
TEST(SchroederPhasesTest, EqualAmplitudesGiveTheQuadraticLaw) {
  const auto sut = schroeder_phases(std::vector<double>(16, 2.0));
  for (int k = 1; k <= 16; ++k) {
    const double expected = -std::numbers::pi * k * (k - 1) / 16.0;
    const double phase_rad = sut[static_cast<std::size_t>(k - 1)];
    ASSERT_NEAR(std::cos(phase_rad - expected), 1.0, 1e-12);
    ASSERT_TRUE(phase_rad >= 0.0 && phase_rad < 2.0 * std::numbers::pi) << phase_rad;
  }
}

// Schroeder reports crest factors near 1.7 for a flat comb; equal phases of K sines reach almost
// sqrt(2 K) * 0.72 = 5.8 at K = 32.
TEST(SchroederPhasesTest, CrestFactorOfAFlatCombIsBelowTwo) {
  const auto phases = schroeder_phases(std::vector<double>(32, 1.0));
  std::vector<Component> comb;
  for (std::int64_t k = 1; k <= 32; ++k) {
    comb.push_back({k, 1.0, phases[static_cast<std::size_t>(k - 1)]});
  }
  const Multisine sut(4096, kRateHz, comb);
  double peak = 0.0;
  for (std::int64_t n = 0; n < 4096; ++n) peak = std::max(peak, std::abs(sut.at(n).accel_m_s2));
  EXPECT_LT(peak / std::sqrt(16.0), 2.0);
}

}  // namespace
}  // namespace stillhand::signal::multisine_test
