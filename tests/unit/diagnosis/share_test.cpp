// SPDX-License-Identifier: Apache-2.0
// How much of an effect another recording will show, Eq. DG-68 and DG-69.
#include "services/core/diagnosis/share.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "services/core/diagnosis/model/evaluation.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::share_test {

constexpr std::size_t kCount = 6000;

// Two parts of two blocks, d = 1: the residual of a block is its own share.  The blocks miss 3 by
// -2, -1, 0 and 3, which is 4/3 14/4^2 for the variance of the mean; parts of shares 1.5 and 4.5 by
// -3 and 3 of their sums, 2/1 18/4^2.  The first part, of residuals 1 and 2, may grow by a
// twentieth: (1 - s)^2 + (2 - s)^2 = 1.05^2 5, so s^2 - 3 s = 0.1025 5/2.
TEST(ShareTest, TheStandardErrorIsThatOverTheBlocksOrThePartsTheLargerOne) {
  const Eigen::VectorXd d = Eigen::VectorXd::Ones(4);
  const auto sut = [&](const Eigen::Vector4d& residual) {
    return share_of(residual, d, {1, 4, 2, {0, 0, 1, 1}});
  };
  const Share apart = sut({1.0, 2.0, 3.0, 6.0});
  EXPECT_DOUBLE_EQ(apart.estimate, 3.0);
  EXPECT_DOUBLE_EQ(apart.std_error, 1.5);
  EXPECT_DOUBLE_EQ(apart.harmless, 1.5 + std::sqrt(1.5 * 1.5 + 0.1025 * 5.0 / 2.0));
  EXPECT_DOUBLE_EQ(apart.earned(), 0.75) << "1 - (1.5/3)^2, of at most 1";
  EXPECT_DOUBLE_EQ(sut({1.0, 6.0, 3.0, 2.0}).std_error, std::sqrt(4.0 / 3.0 * 14.0 / 16.0));
  const Share alone = share_of(d, Eigen::Vector4d(1.0, 0.0, 0.0, 0.0), {1, 4, 2, {0, 0, 1, 1}});
  EXPECT_EQ(alone.std_error, alone.estimate) << "one block says nothing of its own error";
  EXPECT_EQ(share_of(d, 0.0 * d, {1, 4, 2, {0, 0, 1, 1}}).earned(), 0.0) << "no difference";
}

// Two parts of three are ten times as large and want all of it; the third wants none, and its error
// is 1 where the effect adds 1: 1 + s^2 <= 1.05^2.
TEST(ShareTest, NoPartIsMadeWorseByMoreThanATwentieth) {
  const Eigen::Vector<double, 6> difference{10.0, 10.0, 10.0, 10.0, 1.0, 1.0};
  const Eigen::Vector<double, 6> residual{10.0, 10.0, 10.0, 10.0, 1.0, -1.0};
  const Share sut = share_of(residual, difference, {2, 3, 3, {0, 1, 2}});
  EXPECT_DOUBLE_EQ(sut.estimate, 400.0 / 402.0);
  EXPECT_NEAR(sut.harmless, std::sqrt(0.1025), 1e-12);
  EXPECT_EQ(sut.earned(), sut.harmless);
}

TEST(ShareTest, TheStandardErrorTakesItsSquareOfTheEstimate) {
  EXPECT_DOUBLE_EQ((Share{.estimate = 0.5, .std_error = 0.25}).earned(), 0.5 * (1.0 - 0.25));
  EXPECT_EQ((Share{.estimate = 0.3, .std_error = 0.3}).earned(), 0.0);
  EXPECT_EQ((Share{.estimate = -0.5, .std_error = 0.1}).earned(), 0.0);
  EXPECT_EQ((Share{.estimate = 1.4, .std_error = 0.1}).earned(), 1.0)
      << "never more than the effect";
  EXPECT_EQ((Share{.estimate = 0.95, .std_error = 0.05}).earned(), 1.0)
      << "near enough to the whole";
  EXPECT_EQ(rounded_share(0.099), 0.0);
  EXPECT_EQ(rounded_share(0.101), 0.101);
  EXPECT_EQ(rounded_share(0.899), 0.899);
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
  // Means over each sample and the one before: 1 1 0 -1; of two stretches 1 1 -1 -1.
  const Eigen::Vector4d step(6.0, 6.0, 4.0, 4.0);
  EXPECT_DOUBLE_EQ(slow_share(step, {{0, 4, 0.0}}, 2), 0.75);
  EXPECT_DOUBLE_EQ(slow_share(step, {{0, 2, 0.0}, {2, 4, 0.02}}, 2), 1.0);
}

}  // namespace stillhand::diagnosis::share_test
