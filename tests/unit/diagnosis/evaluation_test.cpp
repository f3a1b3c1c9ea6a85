// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/model/evaluation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::evaluation_test {

using made::column_of;
using testing::DoubleNear;
using testing::Each;
using testing::ElementsAre;
using testing::Pointwise;

constexpr std::size_t kCount = 2001;
constexpr std::size_t kCut = 1200;

Signals signals_of(const std::vector<double>& u, const std::vector<double>& y) {
  Measurement measurement = made::measurement_of({{"u", "V", u}, {"y", "N", y}});
  return {made::cut_in_two(std::move(measurement), kCut, 5.0), {"u"}, "y"};
}

TEST(EvaluationTest, ThroughPolesIsTheRecursionOfEveryStretch) {
  const std::vector<Stretch> stretches{{0, 3, 0.0}, {3, 6, 9.0}};
  // y(n) = x(n) + y(n-1)/2 - y(n-2)/4: dyadic, so exact.
  EXPECT_THAT(through_poles({1.0, 0.0, 2.0, 4.0, 0.0, 0.0}, {1.0, -0.5, 0.25}, stretches),
              ElementsAre(1.0, 0.5, 2.0, 4.0, 2.0, 0.0));
  EXPECT_THAT(through_poles({1.0, 5.0, 2.0}, {1.0}, {{0, 3, 0.0}}), ElementsAre(1.0, 5.0, 2.0));
  // Each order has a recursion of its own.
  const std::vector<double> x = made::white(50, 7);
  std::vector<double> a{1.0};
  for (int order = 1; order <= 8; ++order) {
    a.push_back(0.3 / order - 0.1);
    EXPECT_THAT(through_poles(x, a, {{0, 50, 0.0}}),
                Pointwise(DoubleNear(1e-12), made::answer({1.0}, a, x)))
        << order;
  }
  EXPECT_THAT(through_path({4.0, 0.0, 2.0, 8.0, 0.0}, std::vector{1.0, 2.0}, {1.0, -0.5},
                           {{0, 3, 0.0}, {3, 5, 9.0}}),
              ElementsAre(4.0, 10.0, 7.0, 8.0, 20.0));
  EXPECT_THAT(lagged({1.0, 3.0, 2.0, 7.0, 8.0}, 1, {{0, 3, 0.0}, {3, 5, 9.0}}),
              ElementsAre(1.0, 1.0, 3.0, 7.0, 7.0));
}

TEST(EvaluationTest, APredictionMayBeAMillionTimesTheOutput) {
  Signal output;
  EXPECT_EQ(runaway_bound(output), 1e30) << "nothing to compare with";
  output.mean = -3.0;
  output.deviation = 1.0;
  EXPECT_EQ(runaway_bound(output), 4e6);
}

TEST(EvaluationTest, DifferencesStartFromRestInEveryStretch) {
  EXPECT_THAT(differenced({1.0, 3.0, 2.0, 7.0, 7.0}, {{0, 3, 0.0}, {3, 5, 9.0}}),
              ElementsAre(1.0, 2.0, -1.0, 7.0, 0.0));
}

// What the body does on its own from any past, y(n) = -sum a_j y(n-j).
std::vector<double> free_response(const std::vector<double>& a, const std::vector<double>& before,
                                  std::size_t count) {
  std::vector<double> y = before;
  for (std::size_t n = before.size(); n < before.size() + count; ++n) {
    double next = 0.0;
    for (std::size_t j = 1; j < a.size(); ++j) next -= a[j] * y[n - j];
    y.push_back(next);
  }
  return {y.begin() + static_cast<std::ptrdiff_t>(before.size()), y.end()};
}

// The free response counts until the pulse response has decayed to a thousandth of its peak; the
// slowest mode, 2.5 Hz with ratio 0.35, forgets with 5.5/s: within 1.3 s or 130 samples.  What is
// left there is below a few thousandths of the start.
TEST(EvaluationTest, InitialStatesRemoveAFreeResponseAndNothingElse) {
  const Body body = made::four_pole_body();
  const Signals signals = signals_of(made::white(kCount, 1), made::white(kCount, 2));
  const InitialStates sut(body, signals, std::vector<double>(kCount, 1.0));
  std::vector<double> column = free_response(body.denominator, {1.0, -2.0, 0.5, 3.0}, kCut);
  const auto second = free_response(body.denominator, {-0.4, 0.3, 2.0, -1.0}, kCount - kCut);
  column.insert(column.end(), second.begin(), second.end());
  const double size = column_of(column).norm();
  Eigen::MatrixXd removed = column_of(column);
  sut.remove_from(removed);
  EXPECT_LT(removed.norm(), 1e-2 * size);
  // Within the window to rounding: 100 samples are well inside it.
  EXPECT_LT(removed.middleRows(0, 100).norm(), 1e-12 * size);
  EXPECT_LT(removed.middleRows(kCut, 100).norm(), 1e-12 * size);
  // Nothing is touched from 2 s after a start on.
  const std::vector<double> noise = made::white(kCount, 3);
  Eigen::MatrixXd touched = column_of(noise);
  sut.remove_from(touched);
  for (Eigen::Index n = 200; n < static_cast<Eigen::Index>(kCount); ++n) {
    if (n >= static_cast<Eigen::Index>(kCut) && n < static_cast<Eigen::Index>(kCut) + 200) continue;
    ASSERT_EQ(touched(n, 0), noise[static_cast<std::size_t>(n)]) << n;
  }
  // White noise loses four of its directions a stretch: 8 of 2000, chi-squared within 8 +- 4
  // sqrt 16.
  const double taken = column_of(noise).squaredNorm() - touched.squaredNorm();
  EXPECT_GT(taken, 0.5);
  EXPECT_LT(taken, 24.0);
}

// Eq. DG-10: at most 10 s or a quarter of the record; of bodies that ring for long the stretch.
TEST(EvaluationTest, AFreeResponseIsSoughtForTenSecondsOrAQuarterOfTheRecord) {
  const Body body{{{0.0, 1.0}}, {1.0, -std::exp(-1.0 / 3000.0)}};
  for (const auto& [count, slow, last] :
       {std::tuple{2001, false, 1000}, {6001, false, 1500}, {2001, true, 2000}}) {
    const auto x = made::white(static_cast<std::size_t>(count), 1);
    Signals signals = made::signals_of(x, x);
    if (slow) signals = signals.with_slow_poles();
    const Eigen::VectorXd sut =
        InitialStates(body, signals, std::vector<double>(x.size(), 1.0)).part_of(column_of(x));
    EXPECT_NE(sut[last - 1], 0.0) << count;
    EXPECT_EQ(sut.tail(count - last).norm(), 0.0) << count;
  }
}

// Eq. DG-66: of slow modes those below the excited band, which hold a level.
TEST(EvaluationTest, OfSlowModesThoseWithinTheBandHaveNoInitialState) {
  const auto x = made::ride(kCount, 1);
  const Signals signals = made::signals_of(x, x).with_slow_poles();
  for (const double share : {0.8, 1.2}) {
    const double radius = std::exp(-1.0 / static_cast<double>(kCount));
    const double turn =
        share * 2.0 * std::numbers::pi * signals.lowest_excited_hz() / made::kRateHz;
    const Body body{{{0.0, 1.0, 0.0}}, {1.0, -2.0 * radius * std::cos(turn), radius * radius}};
    const InitialStates sut(body, signals, signals.weight());
    EXPECT_EQ(sut.part_of(column_of(x)).norm() > 0.0, share < 1.0) << share;
  }
}

// Of a mode next to a body without poles, at 0.5 Hz.
TEST(EvaluationTest, AModeThatRingsForAnEighthOfTheRecordHasNoInitialState) {
  const Signals signals = made::signals_of(made::white(kCount, 1), made::white(kCount, 2));
  const double duration_s = 0.01 * static_cast<double>(kCount);
  const auto left_of = [&](double decay_s) {
    const double ratio = 1.0 / (decay_s * 2.0 * std::numbers::pi * 0.5);
    Model model = made::model_of({{{1.0}}, {1.0}, 0.0});
    model.effects = {made::effect_of(
        "resonance", "beside the body", {},
        {{"frequency", "Hz", 0.5, 0.1, 40.0}, {"damping_ratio", "-", ratio, 0.001, 1.0}},
        {0.0, 0.0})};
    Eigen::MatrixXd column(static_cast<Eigen::Index>(kCount), 1);
    for (std::size_t n = 0; n < kCount; ++n) {
      const double t_s = 0.01 * static_cast<double>(n);
      column(static_cast<Eigen::Index>(n), 0) =
          std::exp(-t_s / decay_s) * std::cos(2.0 * std::numbers::pi * 0.5 * t_s);
    }
    const double before = column.norm();
    InitialStates(model, signals, std::vector<double>(kCount, 1.0)).remove_from(column);
    return column.norm() / before;
  };
  EXPECT_LT(left_of(0.05 * duration_s), 0.5);
  EXPECT_EQ(left_of(0.2 * duration_s), 1.0);
}

TEST(EvaluationTest, InitialStatesAreAProjection) {
  const Signals signals = signals_of(made::white(kCount, 1), made::white(kCount, 2));
  const InitialStates sut(made::four_pole_body(), signals, signals.weight());
  const Eigen::VectorXd column = column_of(made::white(kCount, 4));
  Eigen::MatrixXd once = column;
  sut.remove_from(once);
  Eigen::MatrixXd twice = once;
  sut.remove_from(twice);
  EXPECT_LT((twice - once).norm(), 1e-13 * column.norm());
  EXPECT_LT((once + sut.part_of(column) - column).norm(), 1e-13 * column.norm());
  EXPECT_NEAR(sut.part_of(column).dot(once.col(0)), 0.0, 1e-12 * column.squaredNorm());
}

// Weighted samples: the free response is weighted as the column is, so it goes all the same.
TEST(EvaluationTest, InitialStatesCountOnlyWhatWeighs) {
  const Body body = made::two_pole_body();
  const Signals signals = signals_of(made::white(kCount, 1), made::white(kCount, 2));
  std::vector<double> weight(kCount, 1.0);
  for (std::size_t n = 0; n < kCount; n += 3) weight[n] = 0.0;
  const InitialStates sut(body, signals, weight);
  std::vector<double> column = free_response(body.denominator, {1.0, -2.0}, kCut);
  column.resize(kCount, 0.0);
  for (std::size_t n = 0; n < kCount; ++n) column[n] *= weight[n];
  Eigen::MatrixXd removed = column_of(column);
  sut.remove_from(removed);
  EXPECT_LT(removed.middleRows(0, 80).norm(), 1e-12 * column_of(column).norm());
}

TEST(EvaluationTest, AStaticBodyHasNoInitialState) {
  const Signals signals = signals_of(made::white(kCount, 1), made::white(kCount, 2));
  const InitialStates sut({{{1.0}}, {1.0}, 0.0}, signals, signals.weight());
  EXPECT_EQ(sut.part_of(column_of(made::white(kCount, 4))).norm(), 0.0);
}

// The answer of a body that was moving before the record began: the residual from rest is the free
// response, and the model that made it leaves nothing.
TEST(EvaluationTest, TheResidualOfTheTrueModelIsNothingWhateverThePast) {
  const Body body = made::two_pole_body();
  const std::size_t before = 300;
  const auto u = made::white(before + kCount, 5);
  const auto y = made::answer(body, u);
  const auto tail = [&](const std::vector<double>& x) {
    return std::vector<double>(x.begin() + before, x.end());
  };
  // One stretch, so that the past is unknown once.
  const Signals signals = made::signals_of(tail(u), tail(y));
  FreeRun run;
  const Eigen::VectorXd sut = residual_of(made::model_of(body), signals, run);
  // Before the first second nothing is judged; behind it the response is fitted where it is above a
  // thousandth of its peak, and e^(-5.65 t) of it is left: 0.0035 at 1 s.
  EXPECT_LT(sut.cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_LT(sut.tail(kCount - 300).cwiseAbs().maxCoeff(), 1e-6);
  // From rest it is not nothing: the first second shows it, were it judged.
  EXPECT_GT(std::abs(run.prediction[0] - tail(y)[0]), 0.1);
}

TEST(EvaluationTest, WhatIsNotTheBodysIsTakenOffTheOutput) {
  const auto u = made::white(kCount, 1);
  const auto v = made::white(kCount, 2);
  const Body body = made::two_pole_body();
  Measurement measurement =
      made::measurement_of({{"u", "V", u}, {"v", "V", v}, {"y", "N", made::white(kCount, 3)}});
  const Signals signals(measurement, {"u"}, "y");
  Model model = made::model_of(
      body,
      {{"input_saturation", "hard", {"u"}, {{"limit", "V", 0.5, 0.0, 9.0}}, {}},
       made::effect_of("bilinear", "gain of the body", {"v"},
                       {{"sensitivity", "1/V", 0.5, -1.0, 1.0}, constant("centre", "V", 0.0)}),
       {"coupled_input", "static", {"v"}, {}, {1.5}}});
  model.body.offset = 0.7;
  std::vector<double> output = free_run(model, signals).prediction;
  std::vector<std::vector<double>> inputs;
  ASSERT_TRUE(without_effects(model, signals, inputs, output));
  std::vector<double> limited = u;
  for (double& x : limited) x = std::clamp(x, -0.5, 0.5);
  ASSERT_EQ(inputs.size(), 1u);
  EXPECT_EQ(inputs[0], limited);
  // Left: body and offset / gain, gain at least 0.05.
  const auto y = made::settled_answer(body.numerators[0], body.denominator, limited);
  for (std::size_t n = 0; n < kCount; ++n) {
    const double gain = 1.0 + 0.5 * v[n];
    ASSERT_NEAR(output[n], (gain * y[n] + 0.7) / std::max(gain, 0.05), 1e-10) << n;
  }
  model.effects.push_back({"output_saturation", "hard", {}, {{"limit", "N", 1.0, 0.0, 9.0}}, {}});
  EXPECT_FALSE(without_effects(model, signals, inputs, output));
}

}  // namespace stillhand::diagnosis::evaluation_test
