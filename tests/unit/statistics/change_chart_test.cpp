// SPDX-License-Identifier: Apache-2.0
// A lasting change of a mean in the plane, Eq. ST-22 to ST-24.
#include "services/core/statistics/change_chart.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "services/core/signal/random.hpp"

namespace stillhand::statistics::change_chart_test {
namespace {

/// Correlated, with unequal spreads, about a mean that is not zero.
Eigen::Vector2d drawn(signal::Gaussian& gaussian, const Eigen::Vector2d& shift) {
  const double first = gaussian();
  return Eigen::Vector2d{0.8 + 0.2 * first, -0.3 + 0.05 * (0.6 * first + 0.8 * gaussian())} + shift;
}

/// The null of Eq. ST-24: a third of the variance wanders with a time constant of 15 vectors.
class Wandering {
 public:
  explicit Wandering(std::uint64_t seed) : gaussian_(seed, 3), mean_(two()) {}
  Eigen::Vector2d next() {
    constexpr double kKeep = 0.9355;  // exp(-1/15)
    mean_ = kKeep * mean_ + std::sqrt(1.0 - kKeep * kKeep) * two();
    return Eigen::Vector2d{5.0, 2.0} + std::sqrt(1.0 / 3.0) * mean_ + std::sqrt(2.0 / 3.0) * two();
  }

 private:
  Eigen::Vector2d two() {
    const double first = gaussian_();
    return {first, gaussian_()};
  }
  signal::Gaussian gaussian_;
  Eigen::Vector2d mean_;
};

/// False alarms in hours of 900 vectors, each learnt from its beginning.
int false_alarms(double run_length, int hours) {
  ChangeChart sut(run_length);
  int alarms = 0;
  for (int hour = 0; hour < hours; ++hour) {
    Wandering vectors(static_cast<std::uint64_t>(2026 + hour));
    sut.restart();
    for (int n = 0; n < 900; ++n) alarms += sut.step(vectors.next()).changed ? 1 : 0;
  }
  return alarms;
}

// 400 hours: a count of Poisson, 3 standard errors, and a tenth for the fit of ST-24.
TEST(ChangeChartTest, FalseAlarmsComeAsOftenAsStated) {
  EXPECT_NEAR(false_alarms(900.0, 400), 400.0, 3.0 * 20.0 + 40.0);
  EXPECT_NEAR(false_alarms(9000.0, 400), 40.0, 3.0 * 6.3 + 4.0);
}

TEST(ChangeChartTest, FindsAChangeWhenItBeganAndHowLargeItIs) {
  ChangeChart sut(9000.0);
  signal::Gaussian gaussian(7, 7);
  const Eigen::Vector2d shift(0.4, -0.1);  // two standard deviations of each
  for (int n = 0; n < 60; ++n) {
    ASSERT_FALSE(sut.step(drawn(gaussian, Eigen::Vector2d::Zero())).changed);
  }
  for (int n = 0; n < 40; ++n) {
    const ChangeChart::Step step = sut.step(drawn(gaussian, shift));
    if (!step.changed) continue;
    // Two standard deviations: the likeliest place is off by 2 in one of a thousand, and the mean
    // of n vectors since then has a standard error of 0.2/sqrt(n).
    EXPECT_NEAR(static_cast<double>(n + 1 - step.ago), 0.0, 2.0);
    EXPECT_NEAR((step.by - shift).norm(), 0.0, 3.0 * 0.2 / std::sqrt(step.ago) + 0.06);
    return;
  }
  FAIL() << "not found in 40 vectors";
}

// Four vectors are learnt, mean 0 and scatter 2 I; eight wait.  At a distance x the thirteenth then
// has |z|^2 = 2 ln(1 + 4/5 x^2/2) (ST-22) and alarms where |z| is beyond h + 1.5 (ST-23).  At
// R = e^5 h = -3.16 + 3.45 + 2.7075 = 2.9975 (ST-24).
TEST(ChangeChartTest, TheFirstVectorThatIsJudgedAlarmsBeyondTheBound) {
  ChangeChart sut(std::exp(5.0));
  EXPECT_NEAR(sut.threshold(), 2.9975, 1e-12);
  const double bound = std::sqrt((std::exp(0.5 * 4.4975 * 4.4975) - 1.0) / 0.4);
  for (const auto& [before, x, changed] :
       {std::tuple{12, 0.999 * bound, false}, {12, 1.001 * bound, true}, {11, 1e9, false}}) {
    sut.restart();
    for (int n = 0; n < before; ++n) {
      const double side = n % 2 == 0 ? 1.0 : -1.0;
      sut.step(n % 4 < 2 ? Eigen::Vector2d(side, 0.0) : Eigen::Vector2d(0.0, side));
    }
    const ChangeChart::Step step = sut.step({0.0, x});
    EXPECT_EQ(step.changed, changed) << before << " " << x;
    EXPECT_EQ(step.ago, changed ? 1 : 0);
    EXPECT_NEAR((step.by - Eigen::Vector2d(0.0, changed ? x : 0.0)).norm(), 0.0, 1e-9);
  }
}

TEST(ChangeChartTest, ValuesThatNeverDifferAreNoChange) {
  ChangeChart sut(50.0);
  for (int n = 0; n < 1000; ++n) ASSERT_FALSE(sut.step({1.0, 2.0}).changed);
}

}  // namespace
}  // namespace stillhand::statistics::change_chart_test
