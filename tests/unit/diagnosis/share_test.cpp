// SPDX-License-Identifier: Apache-2.0
// How much of an effect another recording will show, Eq. DG-68 and DG-69.
#include "services/core/diagnosis/share.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "services/core/diagnosis/model/evaluation.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::share_test {

using made::column_of;

constexpr std::size_t kCount = 6000;

Blocks thirds() {
  Blocks blocks{200, kCount / 200, 3, {}};
  for (std::size_t b = 0; b < blocks.count; ++b) blocks.fold.push_back(b * 3 / blocks.count);
  return blocks;
}

// Variance of least squares of 0.6 d on d under white noise of 1: 1/sqrt(6000) of the standard
// deviation of d, which is 1: 0.013.  Three of them.
TEST(ShareTest, IsWhatTheResidualHoldsOfTheDifference) {
  const Eigen::VectorXd d = column_of(made::white(kCount, 1));
  const Share sut = share_of(0.6 * d + column_of(made::white(kCount, 2)), d, thirds());
  EXPECT_NEAR(sut.estimate, 0.6, 0.04);
  // Over three parts the standard error itself is uncertain by a factor of two.
  EXPECT_GT(sut.std_error, 0.005);
  EXPECT_LT(sut.std_error, 0.04);
}

TEST(ShareTest, WhatOnePartContradictsIsUncertain) {
  const Eigen::VectorXd d = column_of(made::white(kCount, 1));
  Eigen::VectorXd residual = d;
  residual.head(kCount / 3) *= -1.0;
  const Share sut = share_of(residual, d, thirds());
  // -1, 1 and 1: a mean of 1/3 with a standard error of 2/3.
  EXPECT_NEAR(sut.estimate, 1.0 / 3.0, 0.05);
  EXPECT_NEAR(sut.std_error, 2.0 / 3.0, 0.05);
  EXPECT_EQ(sut.earned(), 0.0);
}

// Two parts of three are ten times as large and want all of it; the third wants none, and its error
// is 1 where the effect adds 1: |1 - s|^2 + .. = 1 + s^2 <= 1.05^2 for s = sqrt(0.1025) = 0.32.
TEST(ShareTest, NoPartIsMadeWorseByMoreThanATwentieth) {
  const Eigen::VectorXd d = column_of(made::white(kCount, 1));
  const Eigen::VectorXd noise = column_of(made::white(kCount, 2));
  constexpr Eigen::Index kThird = kCount / 3;
  Eigen::VectorXd difference = 10.0 * d;
  Eigen::VectorXd residual = difference + noise;
  difference.tail(kThird) = d.tail(kThird);
  residual.tail(kThird) = noise.tail(kThird);
  const Share sut = share_of(residual, difference, thirds());
  EXPECT_GT(sut.estimate, 0.95);
  // Products of 2000 samples of noise: 0.022 of each, so that of the root 0.03.
  EXPECT_NEAR(sut.harmless, std::sqrt(0.1025), 0.07);
  EXPECT_EQ(sut.earned(), sut.harmless);
}

TEST(ShareTest, OfNoDifferenceNothingIsEarned) {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(kCount);
  EXPECT_EQ(share_of(column_of(made::white(kCount, 2)), none, thirds()).earned(), 0.0);
}

TEST(ShareTest, TheStandardErrorTakesItsSquareOfTheEstimate) {
  EXPECT_DOUBLE_EQ((Share{.estimate = 0.5, .std_error = 0.25}).earned(), 0.5 * (1.0 - 0.25));
  EXPECT_EQ((Share{.estimate = 0.3, .std_error = 0.3}).earned(), 0.0);
  EXPECT_EQ((Share{.estimate = -0.5, .std_error = 0.1}).earned(), 0.0);
  EXPECT_EQ((Share{.estimate = 1.4, .std_error = 0.1}).earned(), 1.0)
      << "never more than the effect";
  EXPECT_EQ((Share{.estimate = 0.95, .std_error = 0.05}).earned(), 1.0)
      << "near enough to the whole";
}

// Every stage scales with the share: at a share of 0 the model is linear, and a term or a delay of
// half the size is one at half the share.
TEST(ShareTest, AnEffectOfHalfTheSizeIsOneAtHalfTheShare) {
  const std::vector<double> u = made::ride(1000, 1);
  const std::vector<double> v = made::ride(1000, 2);
  const Measurement measurement =
      made::measurement_of({{"u", "V", u}, {"v", "V", v}, {"y", "N", u}});
  const Signals signals(measurement, {"u"}, "y");
  const auto run_of = [&](Effect effect, double share) {
    effect.share = share;
    return free_run(made::model_of(made::two_pole_body(), {effect}), signals).prediction;
  };
  Effect path{"coupled_input", "static", {"v"}, {}, {2.0}};
  Effect half = path;
  half.coefficients = {1.0};
  EXPECT_EQ(run_of(path, 0.5), run_of(half, 1.0));
  const Effect limit{"input_saturation", "hard", {"u"}, {{"limit", "V", 0.3, 0.1, 9.0}}, {}};
  const auto whole = run_of(limit, 1.0);
  const auto linear = free_run(made::model_of(made::two_pole_body()), signals).prediction;
  const auto between = run_of(limit, 0.25);
  for (std::size_t n = 0; n < whole.size(); ++n) {
    // The body behind the map is linear: rounding alone.
    ASSERT_NEAR(between[n], 0.75 * linear[n] + 0.25 * whole[n], 1e-9) << n;
  }
}

TEST(ShareTest, AnEffectThatActsInPartKeepsItsNumbersInAFit) {
  Effect path{"coupled_input", "static", {"v"}, {}, {2.0}};
  path.share = 0.5;
  Model model = made::model_of(made::two_pole_body(), {path});
  const Eigen::VectorXd numbers = packed(model);
  EXPECT_EQ(numbers.size(), packed(made::model_of(made::two_pole_body())).size());
  unpack(0.5 * numbers, model);
  EXPECT_EQ(model.effects[0].coefficients[0], 2.0);
}

// A mean over 100 samples keeps nothing of a sine of 100 but at the end, where it is over fewer: 50
// of 6000.  Of one of 6000 it keeps sinc^2(1/60) = 0.999.
TEST(ShareTest, WhatAMeanOverAPeriodKeepsIsSlow) {
  Eigen::VectorXd quick(kCount);
  Eigen::VectorXd slow(kCount);
  for (std::size_t n = 0; n < kCount; ++n) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(n) / 100.0;
    quick[static_cast<Eigen::Index>(n)] = std::sin(turn);
    slow[static_cast<Eigen::Index>(n)] = std::sin(turn / 60.0);
  }
  const std::vector<Stretch> whole{{0, kCount, 0.0}};
  EXPECT_LT(slow_share(quick, whole, 100), 0.01);
  EXPECT_GT(slow_share(slow, whole, 100), 0.99);
  EXPECT_NEAR(slow_share(quick + slow, whole, 100), 0.5, 0.01);
}

}  // namespace stillhand::diagnosis::share_test
