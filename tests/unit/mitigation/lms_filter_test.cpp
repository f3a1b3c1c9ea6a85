// SPDX-License-Identifier: Apache-2.0
// Normalised LMS with the acceleration as reference: Eq. MI-3.
#include "services/core/cancellation/parts/lms_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "services/core/contract/config_error.hpp"
#include "services/core/signal/band_pass.hpp"
#include "services/core/signal/second_order_lag.hpp"
#include "tests/support/rms_share.hpp"

namespace stillhand::cancellation::lms_filter_test {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr int kTicks = 60'000;
constexpr int kLast = 10'000;  // that are judged

// The paper's tracking motion in short: 14 sines of 0.7 to 2 Hz, 1.6 m/s^2 RMS.
class Motion {
 public:
  explicit Motion(unsigned seed) {
    std::mt19937_64 engine(seed);
    std::uniform_real_distribution<double> draw(0.0, kTurn);
    for (double& phase : phases_) phase = draw(engine);
  }
  double at(int tick) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < phases_.size(); ++k) {
      sum += std::sin(kTurn * (0.7 + 0.1 * static_cast<double>(k)) * 1e-3 * tick + phases_[k]);
    }
    return 1.6 * std::sqrt(2.0 / static_cast<double>(phases_.size())) * sum;
  }

 private:
  std::array<double, 14> phases_{};
};

// A hand of 3 Hz on 1100 N/m that is shaken with 3 N per m/s^2.
struct Hand {
  signal::SecondOrderLag lag{kTurn * 3.0, 0.3, 1e-3};
  double step(double force_n) { return lag.step(force_n / 1100.0).x; }
};
constexpr double kFeedthrough_n_s2_m = -3.0;

// Eq. MI-3 by its sums, both forms.  eps is that of a platform that stands still: 0.05 m/s^2 at
// each of the 50 weights.
TEST(LmsFilterTest, EachUpdateIsThatOfTheEquation) {
  for (const bool force : {false, true}) {
    const SecondaryPath hand{1.0, 12.0, 900.0};  // 30 rad/s, a damping ratio of 0.2
    LmsFilter sut(force ? LmsConfig{0.05, hand} : LmsConfig{0.05});
    signal::BandPass of_u(2, 0.5, force ? 3.0 : 6.0, 1000.0);
    signal::BandPass of_e = of_u;
    signal::SecondOrderLag path(30.0, 0.2, 1e-3);
    std::vector<double> a(500), u(500), w(50);  // 0.5 s of rest
    for (std::size_t n = 501; n <= 3500; ++n) {
      const double t = static_cast<double>(n);
      a.push_back(std::sin(0.008 * t) + 0.3 * std::sin(0.02 * t + 1.0));
      u.push_back(of_u.step(force ? path.step(a.back() / 900.0).x : a.back()));
      double y = 0.0;
      double power = 50.0 * std::pow(force ? 0.05 / 900.0 : 0.05, 2);
      for (std::size_t i = 0; i < 50; ++i) y += w[i] * a[n - 1 - 10 * i];
      for (std::size_t i = 0; i < 50; ++i) power += std::pow(u[n - 1 - 10 * i], 2);
      ASSERT_NEAR(sut.output(a.back()), y, 1e-9 * std::abs(y) + 1e-10) << n;
      sut.learn(0.01 * std::cos(0.011 * t), true);
      const double e = of_e.step(0.01 * std::cos(0.011 * t));
      if (n % 10 != 0) continue;
      for (std::size_t i = 0; i < 50; ++i) w[i] += 0.05 * e / power * u[n - 1 - 10 * i];
    }
    EXPECT_NE(w[49], 0.0);
  }
}

// After a minute less than 5 % of the motion is left: 50 weights can copy this plant in the band to
// 1 %, and mu = 0.05 has settled by then.
TEST(LmsFilterTest, TakesAKnownPlantsMotionOffTheCommand) {
  LmsFilter sut({.step = 0.05});
  const Motion motion(1);
  Hand hand;
  support::RmsShare left;
  for (int n = 0; n < kTicks; ++n) {
    const double a = motion.at(n);
    const double x = hand.step(kFeedthrough_n_s2_m * a);
    const double y = sut.output(a);
    sut.learn(x - y, true);
    if (n >= kTicks - kLast) left.add(x - y, x);
  }
  EXPECT_LT(left.value(), 0.05);
}

// The same by a force, with a path of 20 % more stiffness and less damping than the hand's.
TEST(LmsFilterTest, StillsAKnownPlantByAForce) {
  LmsFilter sut(
      {.step = 0.05, .path = SecondaryPath{1100.0 / std::pow(kTurn * 3.0, 2), 20.0, 1320.0}});
  const Motion motion(2);
  Hand with;
  Hand without;
  support::RmsShare left;
  for (int n = 0; n < kTicks; ++n) {
    const double a = motion.at(n);
    const double x = with.step(kFeedthrough_n_s2_m * a - sut.output(a));
    sut.learn(x, true);
    const double x0 = without.step(kFeedthrough_n_s2_m * a);
    if (n >= kTicks - kLast) left.add(x, x0);
  }
  EXPECT_LT(left.value(), 0.10);
}

// A tense hand whose reflex lets it resonate at 3.5 Hz, 9 times the average compliance there; above
// it lies more than 90 degrees from the average one.  In a motion that has a little power up to 6
// Hz, weights that learn there grow without end: with a band to 6 Hz two minutes leave five hundred
// times the motion.
TEST(LmsFilterTest, AHandThatResonatesAboveTheMotionIsNotDrivenByTheForce) {
  LmsFilter sut({.step = 0.02, .path = SecondaryPath{}});
  const Motion motion(4);
  signal::SecondOrderLag with(kTurn * 3.5, 0.05, 1e-3);
  signal::SecondOrderLag without = with;
  support::RmsShare left;
  for (int n = 0; n < 2 * kTicks; ++n) {
    const double a = motion.at(n) + 0.02 * std::sin(kTurn * 4.0 * 1e-3 * n);
    const double x = with.step((kFeedthrough_n_s2_m * a - sut.output(a)) / 811.0).x;
    sut.learn(x, true);
    const double x0 = without.step(kFeedthrough_n_s2_m * a / 811.0).x;
    if (n >= 2 * kTicks - kLast) left.add(x, x0);
  }
  EXPECT_LT(left.value(), 0.3);
}

// Motion that the acceleration does not explain moves the weights about, and no further: with
// mu = 0.005 and a wanted motion as large as the shaken one, a known plant keeps to 15 %.
TEST(LmsFilterTest, WantedMotionAveragesOut) {
  LmsFilter sut({.step = 0.005});
  const Motion motion(3);
  Hand hand;
  support::RmsShare left;
  for (int n = 0; n < 3 * kTicks; ++n) {
    const double a = motion.at(n);
    const double x = hand.step(kFeedthrough_n_s2_m * a);
    const double wanted = 0.006 * std::sin(kTurn * 0.31 * 1e-3 * n);
    const double y = sut.output(a);
    sut.learn(x + wanted - y, true);
    if (n >= 3 * kTicks - kLast) left.add(x - y, x);
  }
  EXPECT_LT(left.value(), 0.15);
}

TEST(LmsFilterTest, LearnsNothingWhileItMayNotOrWhileThePlatformStandsStill) {
  LmsFilter sut({.step = 0.05});
  for (int n = 0; n < 2000; ++n) {
    sut.output(std::sin(0.01 * n));
    sut.learn(0.01 * std::sin(0.01 * n), false);
  }
  for (const double weight : sut.weights()) ASSERT_EQ(weight, 0.0);
  LmsFilter still({.step = 0.05});
  for (int n = 0; n < 2000; ++n) {
    still.output(0.0);
    still.learn(0.01 * std::sin(0.01 * n), true);
  }
  for (const double weight : still.weights()) ASSERT_EQ(weight, 0.0);
}

TEST(LmsFilterTest, RefusesSettingsOutOfRange) {
  EXPECT_THROW(LmsFilter({.step = 0.0}), ConfigError);
  EXPECT_THROW(LmsFilter({.step = 2.0}), ConfigError);
  EXPECT_THROW(LmsFilter({.step = 0.1, .path = SecondaryPath{1.0, 1000.0, 100.0}}), ConfigError);
}

}  // namespace stillhand::cancellation::lms_filter_test
