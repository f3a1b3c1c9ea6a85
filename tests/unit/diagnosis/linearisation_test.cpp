// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

// linearised() against central differences of free_run(), with every kind of stage in the model.
namespace stillhand::diagnosis::linearisation_test {

constexpr std::size_t kCount = 601;

Signals signals_of() {
  Measurement measurement = made::measurement_of({{"u", "V", made::ride(kCount, 1)},
                                                  {"w", "V", made::ride(kCount, 2)},
                                                  {"v", "V", made::ride(kCount, 3)},
                                                  {"y", "N", made::ride(kCount, 4)}});
  for (std::size_t n = 200; n < 220; ++n) measurement.weight[n] = 0.0;  // a filled gap
  return {made::cut_in_two(std::move(measurement), 350, 2.0), {"u", "w"}, "y"};
}

Model model_with(std::vector<Effect> effects) {
  Model model = made::model_of(made::four_pole_body(), std::move(effects));
  model.inputs = {"u", "w"};
  model.body.numerators.push_back({0.1, 0.05, -0.2, 0.1, 0.02});
  model.body.offset = 0.3;
  return model;
}

// Central differences, initial states taken out with the poles held: what linearised() promises.
Eigen::VectorXd column_by_differences(const Model& model, const Signals& signals, Eigen::Index i) {
  const Eigen::Index numbers_of_body = packed(made::model_of(model.body)).size();
  const Eigen::VectorXd numbers = packed(model);
  const double step = i < numbers_of_body ? 1e-6 : 1e-4 * std::abs(numbers[i]);
  Eigen::VectorXd prediction[2];
  for (int side = 0; side < 2; ++side) {
    Eigen::VectorXd changed = numbers;
    changed[i] += side == 0 ? -step : step;
    Model moved = model;
    unpack(changed, moved);
    const FreeRun run = free_run(moved, signals);
    EXPECT_TRUE(run.finite);
    prediction[side] = Eigen::Map<const Eigen::VectorXd>(
        run.prediction.data(), static_cast<Eigen::Index>(run.prediction.size()));
  }
  const std::vector<double> weight = free_run(model, signals).weight;
  Eigen::MatrixXd column = (prediction[1] - prediction[0]) / (2.0 * step);
  for (Eigen::Index n = 0; n < column.rows(); ++n) {
    column(n, 0) *= weight[static_cast<std::size_t>(n)];
  }
  const InitialStates initial(model, signals, weight);
  initial.remove_from(column);
  return column.col(0);
}

// The body's step is 1e-6, where A(1), what its rest depends on, is 4e-3: (1e-6/4e-3)^2 from the
// third derivative, rounding of 1e-13 over 1e-6.  An effect's step is 1e-4 of its number: 1e-8
// times how it bends, rounding 1e-9.
constexpr double kExact = 1e-5;
// linearised()'s own forward differences of a millionth miss by the second derivative.  With
// feedback they are taken of the body, too: 1e-6/4e-3 = 2.5e-4.
constexpr double kWithFeedback = 1e-3;
// A mode's frequency: 4.3e-6 Hz of a width of 0.06 times 4.3 Hz.
constexpr double kOfAMode = 5e-5;

void expect_columns_agree(const Model& model, const Signals& signals, double tolerance = kExact) {
  const Linearisation sut = linearised(model, signals);
  ASSERT_TRUE(sut.finite);
  ASSERT_EQ(sut.jacobian.cols(), packed(model).size());
  for (Eigen::Index i = 0; i < sut.jacobian.cols(); ++i) {
    const Eigen::VectorXd want = column_by_differences(model, signals, i);
    EXPECT_GT(want.norm(), 0.0) << "number " << i;
    EXPECT_LT((sut.jacobian.col(i) - want).norm(), tolerance * want.norm()) << "number " << i;
  }
}

TEST(LinearisationTest, ColumnsOfTheBodyAreItsDerivatives) {
  expect_columns_agree(model_with({}), signals_of());
}

TEST(LinearisationTest, AStaticBodyHasItsInputsAsColumns) {
  Model model = model_with({});
  model.body.numerators = {{2.0}, {0.5}};
  model.body.denominator = {1.0};
  expect_columns_agree(model, signals_of());
}

TEST(LinearisationTest, EveryStageAgrees) {
  const Signals signals = signals_of();
  const auto one = [](double value) {
    return std::vector<Parameter>{{"value", "-", value, -50.0, 50.0}};
  };
  const Effect whole[] = {
      {"delay", "of the input", {}, one(0.0237), {}},
      made::effect_of("clock_drift", "of the output", {},
                      {{"drift", "us/s", 900.0, -2e4, 2e4}, constant("reference_time", "s", 3.0)}),
      {"input_saturation", "soft", {"u"}, one(1.1), {}},
      {"nonlinear_stiffness", "bent of the output", {}, one(2.0), {-0.001, 0.003, 0.01, 0.02}},
      {"hysteresis", "smooth of the output", {}, one(1.0), {-0.001, 0.003, 0.01, 0.02}},
      made::effect_of("asymmetry", "square inside the body", {}, {},
                      {0.002, 0.003, 0.01, -0.02, 0.01, 0.004, 0.01, -0.03, 0.02, 0.1, -0.0005,
                       0.002, 0.005, 0.01}),
      made::effect_of("bilinear", "gain of the body", {"v"},
                      {{"sensitivity", "1/V", 0.3, -1.0, 1.0}, constant("centre", "V", 0.1)}),
      made::effect_of("time_varying_gain", "sinusoidal", {},
                      {{"cycles_per_record", "-", 1.7, 0.5, 12.0},
                       {"sine", "-", 0.2, -3.0, 3.0},
                       {"cosine", "-", -0.1, -3.0, 3.0}}),
      {"coupled_input", "static", {"v"}, {}, {0.6}},
      {"coupled_input", "lagged", {"v"}, one(0.2), {0.6}},
      {"coupled_input", "through the body", {"v"}, {}, {0.02, 0.1, -0.2, 0.1, 0.05}},
      made::effect_of(
          "resonance", "beside the body", {},
          {{"frequency", "Hz", 4.3, 0.1, 40.0}, {"damping_ratio", "-", 0.06, 0.003, 0.95}},
          {0.2, -0.1, 0.15, 0.05}),
      {"output_saturation", "soft", {}, one(4.0), {}},
      made::effect_of(
          "transients", "isolated bursts", {},
          {{"begin_1", "s", 1.3, 0.0, 9.0, false}, {"end_1", "s", 1.9, 0.0, 9.0, false}}),
  };
  for (const Effect& effect : whole) {
    SCOPED_TRACE(effect.kind + ", " + effect.form);
    const bool feedback = effect_kind(effect.kind).stage(effect) == Stage::kFeedback;
    const double slow = effect.kind == "resonance" ? kOfAMode : kExact;
    expect_columns_agree(model_with({effect}), signals, feedback ? kWithFeedback : slow);
  }
}

// Together every column changes: slopes of the map, gains and the feedback multiply the others'.
TEST(LinearisationTest, StagesTogetherAgree) {
  const Signals signals = signals_of();
  std::vector<Effect> effects{
      {"delay", "of the input", {}, {{"delay", "s", 0.0237, -0.1, 0.5}}, {}},
      made::effect_of("bilinear", "gain of the body", {"v"},
                      {{"sensitivity", "1/V", 0.3, -1.0, 1.0}, constant("centre", "V", 0.1)}),
      {"coupled_input", "through the body", {"v"}, {}, {0.02, 0.1, -0.2, 0.1, 0.05}},
      {"output_saturation", "soft", {}, {{"limit", "N", 4.0, 0.1, 50.0}}, {}}};
  expect_columns_agree(model_with(effects), signals);
  effects.push_back(made::effect_of("nonlinear_stiffness", "bent of the output", {},
                                    {{"threshold", "N", 2.0, 0.1, 9.0}},
                                    {-0.001, 0.003, 0.01, 0.02}));
  expect_columns_agree(model_with(effects), signals, kWithFeedback);
}

// At a bound a number can move one way alone; the derivative is the same there.
TEST(LinearisationTest, ANumberAtItsBoundStillHasItsDerivative) {
  const Signals signals = signals_of();
  const auto limited = [](double lower, double upper) {
    return model_with(
        {{"input_saturation", "soft", {"u"}, {{"limit", "V", 1.0, lower, upper}}, {}}});
  };
  const Eigen::VectorXd free = linearised(limited(0.1, 9.0), signals).jacobian.rightCols(1);
  for (const auto& [lower, upper] : {std::pair{1.0, 9.0}, {0.1, 1.0}, {0.1, 1.0 + 3e-7}}) {
    const Eigen::VectorXd bound = linearised(limited(lower, upper), signals).jacobian.rightCols(1);
    // Forward against backward differences: the second derivative times a millionth.
    EXPECT_LT((bound - free).norm(), 2e-5 * free.norm()) << lower << " to " << upper;
  }
}

TEST(LinearisationTest, TheResidualIsWeightedOutputLessPrediction) {
  const Signals signals = signals_of();
  const Model model = model_with({});
  const Linearisation sut = linearised(model, signals);
  Eigen::MatrixXd want(static_cast<Eigen::Index>(kCount), 1);
  for (std::size_t n = 0; n < kCount; ++n) {
    want(static_cast<Eigen::Index>(n), 0) =
        signals.weight()[n] * (signals.output().values[n] - sut.run.prediction[n]);
  }
  const InitialStates initial(model.body, signals, signals.weight());
  initial.remove_from(want);
  EXPECT_LT((sut.residual - want.col(0)).norm(), 1e-12 * want.norm());
  for (Eigen::Index n = 200; n < 220; ++n) EXPECT_EQ(sut.residual[n], 0.0) << n;
  FreeRun run;
  EXPECT_EQ(residual_of(model, signals, run), sut.residual);
}

}  // namespace stillhand::diagnosis::linearisation_test
