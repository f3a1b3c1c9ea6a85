// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/screening.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::screening_test {

constexpr std::size_t kCount = 6001;
constexpr double kNoise = 0.05;

// 0.09 of 0.09 + 0.0025 is the channel's, less what the body's own numbers had taken of it; the
// coefficient is known to 0.05/sqrt(6000) = 0.0007.
TEST(ScreeningTest, AColumnThatIsMissingGainsItsShare) {
  const made::Studied of(made::with_another_channel(kCount), 2);
  const ScreenedGain sut = of.screening.gain({of.signals.at("v").values});
  EXPECT_NEAR(sut.share, 1.0 - kNoise * kNoise / (0.09 + kNoise * kNoise), 0.01);
  EXPECT_NEAR(sut.coefficients.at(0), 0.3, 0.003);
  EXPECT_LT(sut.p, 1e-5);
  EXPECT_NEAR(of.screening.rmse(), std::hypot(0.3, kNoise), 0.01);
}

// Held out, a number without a meaning costs 2/n of the squares.
TEST(ScreeningTest, AColumnWithoutAMeaningGainsNothing) {
  const made::Studied of(made::with_another_channel(kCount), 2);
  double sum = 0.0;
  for (std::uint64_t seed = 100; seed < 110; ++seed) {
    const ScreenedGain sut = of.screening.gain({made::white(kCount, seed)});
    EXPECT_LT(sut.share, 0.004) << seed;  // at most a few squares of a normal deviate over n
    sum += sut.share;
  }
  EXPECT_LT(sum / 10.0, 0.0005);
}

// The folds without its one large row give it a coefficient that is beyond any test there.
TEST(ScreeningTest, AColumnWhoseErrorOverflowsGainsNothing) {
  const made::Studied of(made::with_another_channel(kCount), 2);
  std::vector<double> column = made::white(kCount, 4);
  for (double& value : column) value *= 1e-94;
  column[kCount / 2] = 1.0;
  const ScreenedGain sut = of.screening.gain({column});
  EXPECT_LE(sut.share, 0.0);
  EXPECT_EQ(sut.p, 1.0);
}

TEST(ScreeningTest, WhatTheModelHasAlreadyGainsNothing) {
  const made::Studied of(made::with_another_channel(kCount), 2);
  EXPECT_LT(of.screening.gain({of.signals.at("u").values}).share, 0.002);
  EXPECT_LT(of.screening.gain({std::vector<double>(kCount, 1.0)}).share, 0.002);
}

// The model's numbers move along: the same least squares as with all columns at once.
TEST(ScreeningTest, CoefficientsAreThoseOfTheJointLeastSquares) {
  const made::Studied of(made::with_another_channel(kCount), 2);
  const auto extra = made::ride(kCount, 9);
  const ScreenedGain sut = of.screening.gain({of.signals.at("v").values, extra});
  const Linearisation line = linearised(of.baseline.model, of.signals);
  Eigen::MatrixXd all(line.jacobian.rows(), line.jacobian.cols() + 2);
  all.leftCols(line.jacobian.cols()) = line.jacobian;
  Eigen::MatrixXd own(line.jacobian.rows(), 2);
  for (std::size_t n = 0; n < kCount; ++n) {
    own.row(static_cast<Eigen::Index>(n)) << of.signals.weight()[n] * of.signals.at("v").values[n],
        of.signals.weight()[n] * extra[n];
  }
  InitialStates(of.baseline.model.body, of.signals, line.run.weight).remove_from(own);
  all.rightCols(2) = own;
  const Eigen::VectorXd want = all.colPivHouseholderQr().solve(line.residual);
  // The ridge of 1e-9 and normal equations of condition 1e6.
  EXPECT_NEAR(sut.coefficients[0], want[want.size() - 2], 1e-6);
  EXPECT_NEAR(sut.coefficients[1], want[want.size() - 1], 1e-6);
}

TEST(ScreeningTest, PassagesThroughTheBodyAreDifferencesBehindItsPoles) {
  const made::Studied of(made::with_another_channel(kCount), 2);
  const auto x = made::white(kCount, 5);
  const Columns sut = of.screening.through_body(x);
  ASSERT_EQ(sut.size(), 3u);
  const auto& a = of.baseline.model.body.denominator;
  const auto passed = made::settled_answer({1.0}, a, x);
  const auto differences = made::settled_answer({1.0, -2.0, 1.0}, a, x);
  for (std::size_t n = 0; n < kCount; n += 7) {
    // Sums of some hundred terms of up to 20: rounding.
    ASSERT_NEAR(sut[0][n], passed[n], 1e-10) << n;
    ASSERT_NEAR(sut[2][n], differences[n], 1e-10) << n;
  }
}

TEST(ScreeningTest, AnEffectIsGivenTheCoefficientsOfItsColumns) {
  const made::Studied of(made::with_another_channel(kCount), 2);
  const auto [effect, gain, body] =
      of.screening.with_coefficients({"coupled_input", "static", {"v"}, {}, {}});
  EXPECT_FALSE(body);
  ASSERT_EQ(effect.coefficients.size(), 1u);
  EXPECT_NEAR(effect.coefficients[0], 0.3, 0.003);
  EXPECT_NEAR(gain, of.screening.gain({of.signals.at("v").values}).share, 1e-12);
  const Proposal passing =
      of.screening.with_coefficients({"coupled_input", "through the body", {"v"}, {}, {}});
  EXPECT_EQ(passing.effect.coefficients.size(), 3u);
  // 0.3 A(q)/A(q) = 0.3: the path through the body can do the same.
  EXPECT_NEAR(passing.gain, gain, 0.01);
}

// Before a clipping output the column counts only where nothing clips.
TEST(ScreeningTest, ColumnsAreSeenThroughTheOutputsMap) {
  Measurement measurement = made::with_another_channel(kCount);
  for (double& y : measurement.channels[2].values) y = std::clamp(y, -0.6, 0.6);
  const Signals signals(measurement, {"u"}, "y");
  const Blocks blocks = make_blocks(signals);
  Model model =
      made::model_of(made::two_pole_body(),
                     {{"output_saturation", "hard", {}, {{"limit", "N", 0.6, 0.01, 9.0}}, {}}});
  fit(model, signals, blocks);
  const ImpulseResponse impulse_response = fit_impulse_response(signals);
  const Screening sut(model, signals, blocks, impulse_response);
  const ScreenedGain gain = sut.gain({signals.at("v").values});
  EXPECT_GT(gain.share, 0.5);
  // One linear step of a problem that isn't: most of the way.
  EXPECT_NEAR(gain.coefficients[0], 0.3, 0.15);
  // Where every prediction clips there is nothing to gain.
  std::vector<double> clipped(kCount);
  for (std::size_t n = 0; n < kCount; ++n) clipped[n] = std::abs(sut.prediction()[n]) >= 0.6;
  EXPECT_LT(std::abs(sut.gain({clipped}).share), 1e-9);
}

}  // namespace stillhand::diagnosis::screening_test
