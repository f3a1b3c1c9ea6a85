// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/fitting/held_out.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::fit_test {

constexpr std::size_t kCount = 2999;

Signals signals_of(const std::vector<double>& y) {
  const std::size_t count = y.size();
  return {made::measurement_of(
              {{"u", "V", made::ride(count, 1)}, {"v", "V", made::ride(count, 2)}, {"y", "N", y}}),
          {"u"},
          "y"};
}

// The free run of a model over these channels: its own difference equation is tested elsewhere.
std::vector<double> output_of(const Model& model) {
  return free_run(model, signals_of(made::white(kCount, 3))).prediction;
}

Effect with_parameter(const char* kind, const char* form, std::vector<std::string> channels,
                      Parameter parameter, std::vector<double> coefficients = {}) {
  return {kind, form, std::move(channels), {std::move(parameter)}, std::move(coefficients)};
}

// Every number 3 % off: a start as a proposal gives it.
Model disturbed(const Model& model) {
  Model start = model;
  Eigen::VectorXd numbers = packed(model);
  for (Eigen::Index i = 0; i < numbers.size(); ++i) numbers[i] *= i % 2 == 0 ? 1.03 : 0.97;
  unpack(numbers, start);
  return start;
}

// Noise-free data, so the minimum is at the numbers that made it, with an error of nothing.
// Levenberg and Marquardt end when a step no longer lowers the squares by 1e-12 of the start's: an
// error of 1e-6 of the start's at most.  Near the minimum the residual is r = J d for numbers that
// are off by d, so |d_i| <= sqrt((J'J)^-1_ii) |r|; 2 for what J itself changes on the way.
void expect_recovered(const Model& truth) {
  const Signals signals = signals_of(output_of(truth));
  const Blocks blocks = make_blocks(signals);
  Model sut = disturbed(truth);
  FreeRun run;
  const double before = residual_of(sut, signals, run).norm();
  const FitOptions options{.max_iterations = 100, .relative_tolerance = 1e-14};
  const FitResult result = fit(sut, signals, blocks, options);
  EXPECT_TRUE(result.finite);
  const double largest = 1e-6 * before;
  EXPECT_LT(residual_of(sut, signals, run).norm(), largest);
  const Eigen::MatrixXd jacobian = linearised(truth, signals).jacobian;
  const Eigen::MatrixXd inverse = (jacobian.transpose() * jacobian).inverse();
  const Eigen::VectorXd want = packed(truth);
  const Eigen::VectorXd got = packed(sut);
  for (Eigen::Index i = 0; i < want.size(); ++i) {
    EXPECT_NEAR(got[i], want[i], 2.0 * std::sqrt(inverse(i, i)) * largest) << "number " << i;
  }
}

TEST(FitTest, AKnownBodyIsRecovered) {
  Model truth = made::model_of(made::two_pole_body());
  truth.body.offset = 0.4;
  expect_recovered(truth);
}

TEST(FitTest, EffectsAndBodyAreRecoveredTogether) {
  const Effect effects[] = {
      with_parameter("delay", "of the input", {}, {"delay", "s", 0.0437, -0.1, 0.5}),
      with_parameter("input_saturation", "hard", {"u"}, {"limit", "V", 1.1, 0.01, 9.0}),
      with_parameter("output_saturation", "hard", {}, {"limit", "N", 0.9, 0.01, 9.0}),
      with_parameter("dead_zone", "at the input", {"u"}, {"half_width", "V", 0.3, 0.0, 9.0}),
      with_parameter("time_varying_gain", "linear", {}, {"change", "-", 0.2, -3.0, 3.0}),
      with_parameter("coupled_input", "lagged", {"v"}, {"lag", "s", 0.15, 0.005, 3.0}, {0.5}),
      with_parameter("resonance", "beside the body", {}, {"frequency", "Hz", 5.0, 0.1, 40.0}),
      {"coupled_input", "through the body", {"v"}, {}, {0.2, 0.1, -0.3}},
      with_parameter("nonlinear_stiffness", "bent of the output", {},
                     {"threshold", "N", 0.8, 0.05, 9.0}, {-0.01, 0.05}),
  };
  for (Effect effect : effects) {
    SCOPED_TRACE(effect.kind + ", " + effect.form);
    if (effect.kind == "resonance") {
      effect.parameters.push_back({"damping_ratio", "-", 0.05, 0.003, 0.95});
      effect.coefficients = {0.3, -0.05};
    }
    Model truth = made::model_of(made::two_pole_body(), {effect});
    truth.body.offset = 0.4;
    expect_recovered(truth);
  }
}

TEST(FitTest, AFitNeverEndsWorseThanItBegan) {
  const Signals signals = signals_of(made::ride(kCount, 9));  // has nothing to do with the input
  const Blocks blocks = make_blocks(signals);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Model sut =
        made::model_of(made::two_pole_body(),
                       {with_parameter("delay", "of the input", {}, {"delay", "s", 0.1, -0.1, 0.5}),
                        with_parameter("nonlinear_stiffness", "cubic of the output", {},
                                       {"threshold", "N", 1.0, 0.05, 9.0}, {-0.01, 0.0})});
    signal::Gaussian draw(seed, 0);
    Eigen::VectorXd numbers = packed(sut);
    for (double& number : numbers) number *= 1.0 + 0.02 * draw();
    unpack(numbers, sut);
    FreeRun run;
    const double before = residual_of(sut, signals, run).norm();
    if (!run.finite) continue;
    const FitOptions options{.max_iterations = 3};
    const FitResult result = fit(sut, signals, blocks, options);
    const double after = residual_of(sut, signals, run).norm();
    EXPECT_TRUE(run.finite);
    EXPECT_TRUE(is_stable(sut.body));
    EXPECT_LE(after, before) << "seed " << seed;
    // Weights sum to the samples that are judged.
    double weight = 0.0;
    for (const double each : run.weight) weight += each;
    EXPECT_NEAR(result.rmse, after / std::sqrt(weight), 1e-12);
  }
}

TEST(FitTest, AStartThatRunsAwayIsLeftAsItIs) {
  const Signals signals = signals_of(made::ride(kCount, 9));
  Model sut = made::model_of(made::two_pole_body());
  sut.body.denominator = {1.0, -2.1, 1.1};
  const Eigen::VectorXd before = packed(sut);
  EXPECT_FALSE(fit(sut, signals, make_blocks(signals)).finite);
  EXPECT_EQ(packed(sut), before);
}

// What a fit kept of its last step is what a linearisation at the same numbers computes again.  A
// number in packed order and back differs in its last digits: 1e-9 of the largest product.
TEST(FitTest, TheGramsAtTheEndAreThoseOfTheFittedModel) {
  const Model truth = made::model_of(
      made::two_pole_body(), {with_parameter("nonlinear_stiffness", "bent of the output", {},
                                             {"threshold", "N", 0.8, 0.05, 9.0}, {-0.01, 0.05})});
  const std::vector<double> noise = made::white(kCount, 4);
  std::vector<double> y = output_of(truth);
  for (std::size_t n = 0; n < kCount; ++n) y[n] += 0.1 * noise[n];
  const Signals signals = signals_of(y);
  const Blocks blocks = make_blocks(signals);
  for (const int iterations : {1, 2, 5, 60}) {
    Model sut = disturbed(truth);
    FitOptions options{.max_iterations = iterations, .grams_at_end = true};
    const FitResult result = fit(sut, signals, blocks, options);
    ASSERT_TRUE(result.grams) << iterations;
    const Linearisation line = linearised(sut, signals);
    const Eigen::MatrixXd want =
        grams_of(line.jacobian, line.residual, line.run.weight, blocks).total(blocks);
    const Eigen::MatrixXd got = result.grams->total(blocks);
    EXPECT_LT((got - want).cwiseAbs().maxCoeff(), 1e-9 * want.cwiseAbs().maxCoeff()) << iterations;
    EXPECT_LT((result.residual - line.residual).norm(), 1e-9 * line.residual.norm());
    // Known at the start, they change nothing.
    Model again = sut;
    Model other = sut;
    options.without_fold = 1;
    const FitResult without = fit(again, signals, blocks, options);
    options.at_start = &*result.grams;
    EXPECT_NEAR(fit(other, signals, blocks, options).rmse, without.rmse, 1e-9 * without.rmse);
  }
  const FitOptions options{.grams_at_end = true};
  Model runs_away = made::model_of(made::two_pole_body());
  runs_away.body.denominator = {1.0, -2.1, 1.1};
  EXPECT_FALSE(fit(runs_away, signals, blocks, options).grams);
}

TEST(FitTest, AFoldThatIsLeftOutDoesNotCount) {
  const Model truth = made::model_of(made::two_pole_body());
  std::vector<double> y = output_of(truth);
  Signals signals = signals_of(y);
  const Blocks blocks = make_blocks(signals);
  // Fold 2 spoilt.
  for (std::size_t n = 0; n < kCount; ++n) {
    if (blocks.fold_of(n / blocks.length) == 2) y[n] += 10.0;
  }
  signals = signals_of(y);
  Model sut = disturbed(truth);
  FitOptions options;
  options.max_iterations = 60;
  options.relative_tolerance = 1e-14;
  options.without_fold = 2;
  const FitResult result = fit(sut, signals, blocks, options);
  EXPECT_LT(result.rmse, 1e-6);
  EXPECT_LT((packed(sut) - packed(truth)).norm(), 1e-6);
  options.without_fold = -1;
  EXPECT_GT(fit(sut, signals, blocks, options).rmse, 1.0);
}

TEST(FitTest, BlocksCoverTheRecordAndFoldsAreSpreadOverIt) {
  struct Case {
    std::size_t samples, length, count;
  };
  // 12000 samples: 30 blocks of 4 s.  3000: 15 of the least 2 s.  600: 10 blocks all the same.
  for (const Case& each :
       {Case{12000, 400, 30}, {12010, 401, 30}, {3000, 200, 15}, {600, 60, 10}, {50, 5, 10}}) {
    const Blocks sut = make_blocks(signals_of(made::white(each.samples, 1)));
    EXPECT_EQ(sut.length, each.length) << each.samples;
    EXPECT_EQ(sut.count, each.count) << each.samples;
    EXPECT_EQ(sut.folds, 5u);
    EXPECT_GE(sut.length * sut.count, each.samples);
    EXPECT_LT(sut.length * (sut.count - 1), each.samples);
    EXPECT_NE(sut.fold_of(3), sut.fold_of(4));
    EXPECT_EQ(sut.fold_of(3), sut.fold_of(8));
  }
  EXPECT_THROW(make_blocks(signals_of(made::white(49, 1))), ConfigError);
}

TEST(FitTest, ARecordWithTooLittleMeasuredIsRefused) {
  Measurement measurement =
      made::measurement_of({{"u", "V", made::ride(kCount, 1)}, {"y", "N", made::ride(kCount, 2)}});
  std::fill(measurement.weight.begin() + 600, measurement.weight.end(), 0.0);
  EXPECT_THROW(make_blocks(Signals(measurement, {"u"}, "y")), ConfigError);
}

// 250 samples in ten blocks of 25; the seam at 130 lies in block 5, of which 20 samples are the
// second recording's.
TEST(FitTest, AFoldOfEveryRecordingHasItsBlocks) {
  Measurement joined =
      made::measurement_of({{"u", "V", made::white(250, 1)}, {"y", "N", made::white(250, 2)}});
  joined.stretches = {{0, 130, 0.0, 0}, {130, 250, 1.3, 1}};
  const Signals signals(joined, {"u"}, "y");
  const Blocks blocks{25, 10, 5};
  const Blocks sut = by_recording(blocks, signals);
  EXPECT_EQ(sut.folds, 2u);
  for (std::size_t b = 0; b < 10; ++b) EXPECT_EQ(sut.fold_of(b), b < 5 ? 0u : 1u) << b;
}

TEST(FitTest, GramsAreTheProductsOfTheirBlocks) {
  const Eigen::MatrixXd j = Eigen::MatrixXd::Random(23, 3);
  const Eigen::VectorXd r = Eigen::VectorXd::Random(23);
  std::vector<double> weight(23, 1.0);
  weight[4] = 0.5;
  const Blocks blocks{5, 5, 2};  // the last of 3 samples
  const Grams sut = grams_of(j, r, weight, blocks);
  Eigen::MatrixXd all(23, 4);
  all << j, r;
  ASSERT_EQ(sut.blocks.size(), 5u);
  EXPECT_LT((sut.blocks[4] - all.bottomRows(3).transpose() * all.bottomRows(3)).norm(), 1e-14);
  EXPECT_LT((sut.total(blocks) - all.transpose() * all).norm(), 1e-13);
  // Without the odd blocks.
  Eigen::MatrixXd even = Eigen::MatrixXd::Zero(4, 4);
  for (const Eigen::Index first : {0, 10, 20}) {
    const auto part = all.middleRows(first, std::min<Eigen::Index>(5, 23 - first));
    even += part.transpose() * part;
  }
  EXPECT_LT((sut.total(blocks, 1) - even).norm(), 1e-13);
  EXPECT_DOUBLE_EQ(sut.weights[0], 4.5);
  EXPECT_DOUBLE_EQ(sut.weights[4], 3.0);
}

// Linear in its numbers: static in the input, an offset, a term.
struct LinearCase {
  Signals signals = signals_of([] {
    std::vector<double> y = made::white(kCount, 5);
    const auto u = made::ride(kCount, 1);
    const auto v = made::ride(kCount, 2);
    for (std::size_t n = 0; n < kCount; ++n) y[n] += 0.5 + 2.0 * u[n] - 0.3 * v[n];
    return y;
  }());
  Blocks blocks = make_blocks(signals);
  Model model =
      made::model_of({{{1.0}}, {1.0}, 0.0}, {{"coupled_input", "static", {"v"}, {}, {0.0}}});
};

// Squared errors of every block by a least-squares fit to the rows of the other folds.
std::vector<double> by_leaving_folds_out(const LinearCase& of) {
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(kCount), 3);
  Eigen::VectorXd y(static_cast<Eigen::Index>(kCount));
  for (std::size_t n = 0; n < kCount; ++n) {
    const auto row = static_cast<Eigen::Index>(n);
    const double weight = of.signals.weight()[n];
    columns.row(row) << weight, weight * of.signals.at("u").values[n],
        weight * of.signals.at("v").values[n];
    y[row] = weight * of.signals.output().values[n];
  }
  std::vector<double> squares(of.blocks.count, 0.0);
  for (std::size_t fold = 0; fold < of.blocks.folds; ++fold) {
    Eigen::MatrixXd training = columns;
    Eigen::VectorXd target = y;
    const auto left_out = [&](std::size_t n) {
      return of.blocks.fold_of(n / of.blocks.length) == fold;
    };
    for (std::size_t n = 0; n < kCount; ++n) {
      if (!left_out(n)) continue;
      training.row(static_cast<Eigen::Index>(n)).setZero();
      target[static_cast<Eigen::Index>(n)] = 0.0;
    }
    const Eigen::VectorXd b = training.colPivHouseholderQr().solve(target);
    const Eigen::VectorXd error = y - columns * b;
    for (std::size_t n = 0; n < kCount; ++n) {
      if (left_out(n)) {
        squares[n / of.blocks.length] += std::pow(error[static_cast<Eigen::Index>(n)], 2);
      }
    }
  }
  return squares;
}

// For a model that is linear in its numbers one linearisation is exact, up to the ridge: 1e-6 of
// the diagonal moves the step, itself a few hundredths, by 1e-6 of it.
TEST(FitTest, LinearisedAndRefittedCrossValidationEqualLeavingFoldsOut) {
  LinearCase of;
  fit(of.model, of.signals, of.blocks);
  const Linearisation line = linearised(of.model, of.signals);
  const Grams grams = grams_of(line.jacobian, line.residual, line.run.weight, of.blocks);
  const auto want = by_leaving_folds_out(of);
  for (const HeldOut& sut :
       {held_out_linearised(grams, of.blocks), held_out(of.model, of.signals, of.blocks)}) {
    ASSERT_EQ(sut.squares.size(), want.size());
    EXPECT_TRUE(sut.finite);
    for (std::size_t b = 0; b < want.size(); ++b) EXPECT_NEAR(sut.squares[b] / want[b], 1.0, 1e-6);
  }
}

// What is held out of white noise is its RMS, more by half the share of fitted numbers: 3 of 2400.
// The RMS of 2900 judged samples is known to 1/sqrt(2 2900) = 1.3 %; four times that.
TEST(FitTest, HeldOutOfPureNoiseIsItsRootMeanSquare) {
  LinearCase of{.signals = signals_of(made::white(kCount, 6))};
  fit(of.model, of.signals, of.blocks);
  EXPECT_NEAR(held_out(of.model, of.signals, of.blocks).rmse(), 1.0, 0.053);
}

// A fit sees less than what it leaves elsewhere; with as many numbers as 60 the gap shows: within
// sqrt(1 - 60/n), without sqrt(1 + 60/(0.8 n)), n = 900.
TEST(FitTest, HeldOutErrorIsAboveTheFitsOwn) {
  std::vector<Channel> channels{{"u", "V", made::white(1000, 20)}};
  std::vector<std::string> inputs{"u"};
  for (int i = 1; i < 60; ++i) {
    inputs.push_back("u" + std::to_string(i));
    channels.push_back({inputs.back(), "V", made::white(1000, 20 + static_cast<std::uint64_t>(i))});
  }
  channels.push_back({"y", "N", made::white(1000, 100)});
  const Signals signals(made::measurement_of(std::move(channels)), inputs, "y");
  Model model = made::model_of({std::vector<std::vector<double>>(60, {0.0}), {1.0}, 0.0});
  model.inputs = inputs;
  const Blocks blocks = make_blocks(signals);
  const double own = fit(model, signals, blocks).rmse;
  const double sut = held_out(model, signals, blocks).rmse();
  EXPECT_NEAR(own, std::sqrt(1.0 - 61.0 / 900.0), 0.1);
  EXPECT_NEAR(sut / own, std::sqrt((1.0 + 61.0 / 720.0) / (1.0 - 61.0 / 900.0)), 0.03);
}

// The data want a pole that decays in 50 s, the bound allows 2 s: each step would lead out.
TEST(FitTest, NextToAPoleOnItsBoundTheOtherNumbersMove) {
  const Model truth = made::model_of({{{0.0, 0.05}}, {1.0, -std::exp(-0.01 / 50.0)}, 0.0});
  const Signals signals = signals_of(output_of(truth));
  const Blocks blocks = make_blocks(signals);
  Model sut = truth;
  sut.body.largest_radius = sut.body.slowest_radius = std::exp(-0.01 / 2.0);
  stabilise(sut.body);
  FitOptions options;
  options.without_fold = 0;
  options.max_iterations = 1;
  const double before = fit(sut, signals, blocks, options).rmse;
  options.max_iterations = 4;
  EXPECT_LT(fit(sut, signals, blocks, options).rmse, 0.999 * before);
  EXPECT_TRUE(is_stable(sut.body));
  EXPECT_EQ(radii_on_bound(sut).size(), 1U);
}

}  // namespace stillhand::diagnosis::fit_test
