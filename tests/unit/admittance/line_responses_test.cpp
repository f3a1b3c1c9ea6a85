// SPDX-License-Identifier: Apache-2.0
#include "services/core/admittance/line_responses.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <complex>
#include <utility>
#include <vector>

#include "services/core/contract/units.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/simulated_arm.hpp"

namespace stillhand::admittance::line_responses_test {
namespace {

constexpr double kRate_hz = 250.0;

// Eqs. AD-6 and AD-7: 5 arms, 4 responses at 20 lines, 400 circles.  A line's responses share their
// noise, so about 200 are independent: 95 % less 4 standard deviations of 1.5 % is 88 %.
TEST(LineResponsesTest, TheCirclesHoldTheClosedFormResponseIn95Percent) {
  const Excitation excitation = design({.rate_hz = kRate_hz});
  int inside = 0;
  int all = 0;
  const auto count = [&](const LineResponse& line, std::complex<double> truth) {
    inside += std::abs(line.response - truth) <= line.radius95 ? 1 : 0;
    ++all;
  };
  for (int i = 0; i < 5; ++i) {
    const auto arm = simulated::drawn_arm(1, i);
    const auto run = simulated::run(arm, excitation, kRate_hz, 8, {}, 100 + i);
    EXPECT_LE(run.largest_force_n, 8.0);
    EXPECT_LE(run.largest_acceleration_m_s2, 2.0);
    const LineEstimates sut = estimate(run.record, excitation);
    for (std::size_t k = 0; k < 20; ++k) {
      const auto f = simulated::truth_at(arm, sut.admittance[k].frequency_hz);
      const auto a = simulated::truth_at(arm, sut.feedthrough_to_force[k].frequency_hz);
      count(sut.admittance[k], f.admittance);
      count(sut.stick_per_force[k], f.x_per_force);
      count(sut.feedthrough_to_force[k], a.f_per_accel);
      count(sut.feedthrough_to_position[k], a.x_per_accel);
    }
  }
  EXPECT_GE(inside, all * 88 / 100);
  EXPECT_LT(inside, all);  // circles that hold everything are too wide
}

// Four periods of 1 s at 100 Hz: the motor at 3 Hz, the platform at 5 Hz, and noise on one of each
// line's six neighbours.
TEST(LineResponsesTest, OneNoisyNeighbourOfSixGivesTheVariancesByHand) {
  using Complex = std::complex<double>;
  using namespace std::complex_literals;
  const auto sum = [](const std::vector<std::pair<double, Complex>>& lines) {
    std::vector<double> out(400, 0.0);
    for (std::size_t n = 0; n < out.size(); ++n) {
      for (const auto& [f_hz, size] : lines) {
        out[n] += (size * std::polar(1.0, kTwoPi * f_hz * static_cast<double>(n) / 100.0)).real();
      }
    }
    return out;
  };
  const Complex x_m = 0.02 - 0.03i, f_n = -4.0 + 1.0i, e_x = 0.03, e_f = 0.2 + 0.1i;
  const FreeStickRecord record{100.0, sum({{3.0, 2.0}}), sum({{5.0, 0.5}}),
                               sum({{3.0, x_m}, {3.25, 0.006}, {5.0, 0.1}, {5.5, e_x}}),
                               sum({{3.0, f_n}, {5.0, 1.0}, {5.5, e_f}})};
  const Excitation excitation{signal::Multisine(100, 100.0, {{3, 1.0, 0.0}}),
                              signal::Multisine(100, 100.0, {{5, 1.0, 0.0}})};
  const LineEstimates sut = estimate(record, excitation);
  EXPECT_EQ(sut.neighbours, 6);
  const LineResponse& y = sut.admittance.at(0);
  EXPECT_DOUBLE_EQ(y.frequency_hz, 3.0);
  EXPECT_NEAR(std::abs(y.response + x_m / f_n), 0.0, 1e-14);
  const double variance = 0.006 * 0.006 / 6.0;  // of X
  EXPECT_NEAR(y.variance, variance / 17.0, 1e-15);
  EXPECT_NEAR(y.radius95, std::sqrt(y.variance * 6.0 * (std::pow(0.05, -1.0 / 6.0) - 1.0)), 1e-12);
  EXPECT_NEAR(y.coherence, 0.0013 / (0.0013 + 4.0 * variance), 1e-12);  // |X|^2 = 0.0013
  EXPECT_NEAR(std::abs(sut.stick_per_force.at(0).response - x_m / 2.0), 0.0, 1e-14);
  EXPECT_NEAR(sut.feedthrough_to_force.at(0).variance, 0.05 / 6.0 / 0.25, 1e-12);  // |e_f|^2 = 0.05
  EXPECT_NEAR(std::abs(sut.position_force_covariance.at(0) - e_x * std::conj(e_f) / 6.0 / 0.25),
              0.0, 1e-13);
  EXPECT_NEAR(std::abs(estimate_pegged(record, excitation).at(0).response - 2.0), 0.0, 1e-13);
}

TEST(LineResponsesTest, RefusesARecordThatIsNotFourWholePeriods) {
  const Excitation excitation = design({.rate_hz = kRate_hz});
  FreeStickRecord record;
  for (const std::size_t samples : {15'000u, 20'001u, 20'000u}) {
    record.motor_force_n.assign(samples, 0.0);
    record.acceleration_m_s2 = record.displacement_m = record.hand_force_n = record.motor_force_n;
    EXPECT_THAT(support::refusal([&] { estimate(record, excitation); }),
                testing::HasSubstr(samples == 20'000u ? "accepted" : "whole periods of 5000"));
  }
}

}  // namespace
}  // namespace stillhand::admittance::line_responses_test
