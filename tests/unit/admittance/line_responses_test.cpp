// SPDX-License-Identifier: Apache-2.0
#include "services/core/admittance/line_responses.hpp"

#include <gmock/gmock.h>

#include <complex>

#include "services/core/contract/config_error.hpp"
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

TEST(LineResponsesTest, RefusesARecordThatIsNotWholePeriods) {
  const Excitation excitation = design({.rate_hz = kRate_hz});
  FreeStickRecord record;
  record.motor_force_n.assign(15001, 0.0);
  record.acceleration_m_s2 = record.displacement_m = record.hand_force_n = record.motor_force_n;
  EXPECT_THAT([&] { estimate(record, excitation); },
              testing::ThrowsMessage<ConfigError>(testing::HasSubstr("whole periods of 5000")));
}

}  // namespace
}  // namespace stillhand::admittance::line_responses_test
