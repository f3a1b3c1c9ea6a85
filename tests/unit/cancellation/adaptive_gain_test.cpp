// SPDX-License-Identifier: Apache-2.0
// Gain and phase followed online, Eq. CC-10 to CC-13, on a hand that is a spring, a damper and a
// mass.
#include "services/core/cancellation/parts/adaptive_gain.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <vector>

#include "services/core/signal/random.hpp"
#include "tests/support/feedthrough_records.hpp"

namespace stillhand::cancellation::adaptive_gain_test {
namespace {

constexpr HandCompliance kHand{1.38, 9.5, 844.0, 0.1};

struct Outcome {
  double moved_m = 0.0;    ///< RMS of the hand over the last 30 s
  double unmoved_m = 0.0;  ///< the same without a motor
  AdaptiveGain::Pair weights{};
};

// The true feedthrough is `gain(t)` times the prediction, late by `late` ticks; the hand is
// `true_hand`; the operator moves on his own by `own_n` of slow noise.
Outcome run(const HandCompliance& true_hand, const std::function<double(double)>& gain, int late,
            double own_n, double seconds) {
  const auto ticks = static_cast<std::size_t>(seconds * 1000.0);
  const std::vector<double> predicted = support::band_noise(ticks, 1000.0, 0.7, 2.0, 6.0, 11);
  const std::vector<double> own = support::band_noise(ticks, 1000.0, 0.1, 1.5, own_n, 12);
  const double natural = std::sqrt(true_hand.stiffness_n_m / true_hand.mass_kg);
  const double damping = true_hand.damping_n_s_m / (2.0 * natural * true_hand.mass_kg);
  signal::SecondOrderLag with(natural, damping, 1e-3);
  signal::SecondOrderLag without(natural, damping, 1e-3);
  signal::SecondOrderLag alone(natural, damping, 1e-3);
  AdaptiveGain sut(kHand);
  Outcome out;
  double motor_n = 0.0;
  const std::size_t judged = ticks - 30'000;
  for (std::size_t n = 0; n < ticks; ++n) {
    const std::size_t then =
        n >= static_cast<std::size_t>(late) ? n - static_cast<std::size_t>(late) : 0;
    const double force_n = gain(static_cast<double>(n) * 1e-3) * predicted[then];
    const double x = with.step((force_n + motor_n + own[n]) / true_hand.stiffness_n_m).x;
    const double still = without.step((force_n + own[n]) / true_hand.stiffness_n_m).x;
    const double willed = alone.step(own[n] / true_hand.stiffness_n_m).x;
    motor_n = -sut.step(predicted[n], x / kHand.lever_m, true);
    if (n < judged) continue;
    out.moved_m += (x - willed) * (x - willed) / 30'000.0;
    out.unmoved_m += (still - willed) * (still - willed) / 30'000.0;
  }
  out.moved_m = std::sqrt(out.moved_m);
  out.unmoved_m = std::sqrt(out.unmoved_m);
  out.weights = sut.weights();
  return out;
}

std::function<double(double)> steady(double gain) {
  return [gain](double) { return gain; };
}

TEST(AdaptiveGainTest, WithoutAHandNothingIsFollowed) {
  AdaptiveGain sut;
  for (int n = 0; n < 1000; ++n) EXPECT_EQ(sut.step(3.0, 0.1 * n, true), 3.0);
}

// Eq. CC-11 by a matrix, on a force that dies away: f and f' are correlated then.
TEST(AdaptiveGainTest, EachStepIsNewtonsUntilItIsBounded) {
  constexpr double kDt = 1e-3;
  AdaptiveGain sut(kHand);
  ExplainedMotion motion(kHand);
  Eigen::Vector2d weights(1.0, 0.0);
  Eigen::Matrix2d power = Eigen::Matrix2d::Zero();
  double most_correlated = 0.0;
  for (int n = 0; n < 4000; ++n) {
    const double t = n * kDt;
    const double force_n = 30.0 * std::exp(-t) * std::sin(2.0 * std::numbers::pi * 0.8 * t);
    const double theta_rad = 0.002 * std::sin(2.0 * std::numbers::pi * 0.8 * t + 0.4);
    const auto [r_m, e_m] = motion.step(force_n, theta_rad);
    const Eigen::Vector2d r(r_m[0], r_m[1]);
    power += kDt / 10.0 * (r * r.transpose() - power);
    const Eigen::Matrix2d least = 1e-8 * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d towards = (power + least).inverse() * r * e_m;
    weights += (kDt / 15.0 * towards).cwiseMax(-0.2 * kDt).cwiseMin(0.2 * kDt);
    weights[1] = std::clamp(weights[1], -0.7 * weights[0], 0.7 * weights[0]);
    most_correlated =
        std::max(most_correlated, power(0, 1) * power(0, 1) / ((power + least).diagonal().prod()));
    sut.step(force_n, theta_rad, true);
  }
  EXPECT_GT(most_correlated, 0.3);
  EXPECT_GT((weights - Eigen::Vector2d(1.0, 0.0)).norm(), 0.01);
  EXPECT_NEAR(sut.weights()[0], weights[0], 1e-9);
  EXPECT_NEAR(sut.weights()[1], weights[1], 1e-9);
}

TEST(AdaptiveGainTest, FindsGainAndPhase) {
  for (const double gain : {0.5, 0.8, 1.0, 1.3}) {
    const Outcome out = run(kHand, steady(gain), 0, 1.0, 120.0);
    EXPECT_NEAR(out.weights[0], gain, 0.05) << gain;
    EXPECT_LT(out.moved_m, 0.08 * out.unmoved_m) << gain;
  }
  // 40 ms late: 17 degrees at 1.2 Hz.
  const Outcome late = run(kHand, steady(1.0), 40, 1.0, 120.0);
  EXPECT_NEAR(late.weights[1], -std::sin(2.0 * std::numbers::pi * 1.2 * 0.04), 0.07);
  EXPECT_LT(late.moved_m, 0.12 * late.unmoved_m);
}

TEST(AdaptiveGainTest, ConvergesInTheTimeStated) {
  // Eq. CC-11: the distance falls by e in 15 s on the right hand.
  const Outcome out = run(kHand, steady(0.5), 0, 0.0, 45.0);
  EXPECT_NEAR(out.weights[0], 0.5 + 0.5 * std::exp(-3.0), 0.06);
}

TEST(AdaptiveGainTest, FollowsAHandThatTightens) {
  const auto tightening = [](double t_s) { return 1.0 + 0.4 * (1.0 - std::exp(-t_s / 60.0)); };
  const Outcome followed = run(kHand, tightening, 0, 1.0, 180.0);
  EXPECT_NEAR(followed.weights[0], tightening(165.0), 0.05);
}

// The wrong task's hand, the wrong model: from a quarter to six times the stiffness, a gain of
// nothing to three, a force that comes late by up to a period, even turned round.
TEST(AdaptiveGainTest, IsNeverWorseThanNoCancellation) {
  const HandCompliance hands[] = {kHand,
                                  {1.38, 5.0, 211.0, 0.1},
                                  {1.38, 40.0, 5000.0, 0.1},
                                  {3.0, 30.0, 844.0, 0.1},
                                  {0.7, 20.0, 1700.0, 0.1}};
  for (const HandCompliance& hand : hands) {
    // Eq. CC-11: a stiff hand shows an error more slowly.
    const double seconds = 120.0 * std::max(1.0, hand.stiffness_n_m / kHand.stiffness_n_m);
    for (const double gain : {-1.0, 0.0, 0.3, 1.0, 3.0}) {
      for (const int late : {0, 60, 200, 400}) {
        const Outcome out = run(hand, steady(gain), late, 1.0, seconds);
        // Where there is nothing to cancel a tenth of the prediction may stay.
        const double still_m = gain == 0.0 ? 0.1 * 6.0 / hand.stiffness_n_m : 0.0;
        EXPECT_LT(out.moved_m, 1.05 * out.unmoved_m + still_m)
            << "stiffness " << hand.stiffness_n_m << " mass " << hand.mass_kg << " gain " << gain
            << " late " << late << " weights " << out.weights[0] << " " << out.weights[1];
      }
    }
  }
}

TEST(AdaptiveGainTest, StaysBoundedWhateverComes) {
  AdaptiveGain sut(kHand);
  signal::Gaussian draw(5, 1);
  for (int n = 0; n < 300'000; ++n) {
    const double force_n = sut.step(30.0 * draw(), draw.uniform() < 0.01 ? 1e6 : draw(), true);
    ASSERT_TRUE(std::isfinite(force_n));
    ASSERT_GE(sut.weights()[0], 0.0);
    ASSERT_LE(sut.weights()[0], 1.5);
    ASSERT_LE(std::abs(sut.weights()[1]), 0.7 * sut.weights()[0]);
  }
}

}  // namespace
}  // namespace stillhand::cancellation::adaptive_gain_test
