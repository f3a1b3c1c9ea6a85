// SPDX-License-Identifier: Apache-2.0
// Feedthrough to position of a free stick, METHOD Eq. ID-22, of a known hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "services/core/contract/tick.hpp"
#include "services/core/identification/identifier.hpp"
#include "services/core/signal/difference_model.hpp"
#include "services/core/signal/second_order_lag.hpp"

namespace stillhand::identification::identify_position_test {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
// -3.2 N per m/s^2 on a hand of 1136 N/m with a mode at 4.5 Hz.
constexpr double kStatic_s2 = -3.2 / 1136.0;
constexpr double kMode_hz = 4.5;
constexpr double kDamping = 0.14;

// 40 s of 80 sines of 0.3 to 8.2 Hz, and the hand's own motion of 0.2 mm at 0.2 Hz.
PeggedTrial trial() {
  PeggedTrial out;
  out.number = 1;
  out.record.rate_hz = kControlRateHz;
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> draw(0.0, kTurn);
  std::vector<double> phases(80);
  for (double& phase : phases) phase = draw(engine);
  signal::SecondOrderLag hand(kTurn * kMode_hz, kDamping, kControlPeriod_s);
  for (int n = 0; n < 40'000; ++n) {
    const double t = kControlPeriod_s * n;
    double a = 0.0;
    for (std::size_t k = 0; k < phases.size(); ++k) {
      a += 0.2 * std::sin(kTurn * (0.3 + 0.1 * static_cast<double>(k)) * t + phases[k]);
    }
    out.record.acceleration_m_s2.push_back(a);
    out.record.force_n.push_back(hand.step(kStatic_s2 * a).x + 2e-4 * std::sin(kTurn * 0.2 * t));
  }
  return out;
}

std::complex<double> truth_at(double frequency_hz) {
  const double r = frequency_hz / kMode_hz;
  return kStatic_s2 / std::complex<double>(1.0 - r * r, 2.0 * kDamping * r);
}

// The 50 Hz fit and the own motion cost up to 3 % in the band of a session's motion.
TEST(IdentifyPositionTest, FindsAKnownHandInMetres) {
  const Identification sut = identify_position(trial(), {});
  ASSERT_TRUE(sut.model) << sut.why_not;
  EXPECT_TRUE(sut.model->refined) << "the own motion biases the equation error";
  for (const double f : {0.7, 1.2, 2.0, 3.0}) {
    const std::complex<double> found = signal::response_at(sut.model->control, f);
    EXPECT_LT(std::abs(found / truth_at(f) - 1.0), 0.03) << f;
  }
  EXPECT_LT(sut.model->heldout.free_run_rms_n, 1e-3);  // [m]
}

// The chain of a force in millimetres, refined whether it was asked for or not.
TEST(IdentifyPositionTest, IsTheRefinedChainInMillimetres) {
  PeggedTrial in_mm = trial();
  for (double& x : in_mm.record.force_n) x /= 1e-3;
  const Config refined{.refine = true};
  const Identification wanted = identify(in_mm, refined);
  const Identification sut = identify_position(trial(), {});
  ASSERT_TRUE(wanted.model && sut.model) << wanted.why_not << sut.why_not;
  EXPECT_EQ(sut.model->control.denominator, wanted.model->control.denominator);
  for (std::size_t k = 0; k < wanted.model->control.numerator.size(); ++k) {
    EXPECT_DOUBLE_EQ(sut.model->control.numerator[k], 1e-3 * wanted.model->control.numerator[k]);
  }
}

// The other way round: the platform would add to what it moves.
TEST(IdentifyPositionTest, AnAngleOfTheWrongSignIsRefused) {
  PeggedTrial turned = trial();
  for (double& x : turned.record.force_n) x = -x;
  const Identification sut = identify_position(turned, {});
  EXPECT_FALSE(sut.model);
  EXPECT_THAT(sut.why_not, testing::HasSubstr(" mm per m/s^2, want the other sign"));
  EXPECT_THAT(sut.why_not, testing::HasSubstr("the stick's angle"));
  EXPECT_THAT(sut.why_not, testing::Not(testing::HasSubstr("load cell")));
}

TEST(IdentifyPositionTest, AnAngleThatStandsStillIsNamed) {
  PeggedTrial still = trial();
  for (double& x : still.record.force_n) x = 1e-3;
  const Identification sut = identify_position(still, {});
  EXPECT_FALSE(sut.model);
  EXPECT_THAT(sut.why_not, testing::HasSubstr("the stick's angle is constant"));
  EXPECT_THAT(sut.why_not, testing::Not(testing::HasSubstr("load cell")));
}

}  // namespace
}  // namespace stillhand::identification::identify_position_test
