// SPDX-License-Identifier: Apache-2.0
// Bodies with a nonlinearity that run side by side.
#include "services/core/diagnosis/model/loop.hpp"

#include <gtest/gtest.h>

#include "services/core/diagnosis/model/model_run.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::loop_test {

constexpr std::size_t kCount = 3001;

// A y = B u + q^-1 e_0 phi(y / threshold)
Model looped(const char* kind, const char* form, double threshold, double e0) {
  return made::model_of(made::two_pole_body(),
                        {{kind, form, {}, {{"threshold", "N", threshold, 1e-3, 1e3}}, {e0, 0.0}}});
}

// Bit for bit.
void expect_each_as_alone(const std::vector<Model>& models) {
  const Signals signals = made::signals_of(made::ride(kCount, 1), made::white(kCount, 2));
  std::vector<ModelRun> together(models.size());
  run_all(models, signals, together);
  for (std::size_t i = 0; i < models.size(); ++i) {
    ModelRun alone;
    run_all(models[i], signals, alone);
    EXPECT_EQ(together[i].free.finite, alone.free.finite) << i;
    EXPECT_EQ(together[i].free.body, alone.free.body) << i;
    EXPECT_EQ(together[i].body_before, alone.body_before) << i;
  }
}

// The fifth runs alone.
TEST(LoopTest, FourSideBySideAreAsEachAlone) {
  static_assert(kLoopLanes == 4);
  std::vector<Model> models;
  for (const double threshold : {0.5, 1.0, 1.5, 2.0, 2.5}) {
    models.push_back(looped("hysteresis", "elastic-plastic of the output", threshold, 0.005));
  }
  expect_each_as_alone(models);
}

// What one leaves behind does not reach the others.
TEST(LoopTest, OneThatRunsAwayLeavesTheOthersAlone) {
  std::vector<Model> models;
  for (const double e0 : {-1e-6, 5.0, 1e-6}) {
    models.push_back(looped("nonlinear_stiffness", "cubic of the output", 0.7, e0));
  }
  const Signals signals = made::signals_of(made::ride(kCount, 1), made::white(kCount, 2));
  ASSERT_TRUE(free_run(models[0], signals).finite);
  ASSERT_FALSE(free_run(models[1], signals).finite);
  expect_each_as_alone(models);
}

// y(n) = offset + min(z(n), L - offset), written out: what would have gone beyond is not there
// later.
TEST(LoopTest, AStopHoldsTheOutputAndForgetsWhatWouldGoBeyond) {
  constexpr double kLimit = 0.9;
  Model sut = made::model_of(
      made::two_pole_body(),
      {{"output_saturation", "stop above", {}, {constant("limit", "N", kLimit)}, {}}});
  sut.body.offset = 0.5;
  const auto u = made::ride(kCount, 1);
  const FreeRun run = free_run(sut, made::signals_of(u, made::white(kCount, 2)));
  const auto& b = sut.body.numerators.front();
  const auto& a = sut.body.denominator;
  std::vector<double> want(kCount, 0.0);
  std::size_t stopped = 0;
  for (std::size_t n = 0; n < kCount; ++n) {
    for (std::size_t i = 0; i < 3 && i <= n; ++i) want[n] += b[i] * u[n - i];
    for (std::size_t j = 1; j < 3 && j <= n; ++j) want[n] -= a[j] * want[n - j];
    stopped += want[n] > kLimit - 0.5 ? 1u : 0u;
    want[n] = std::min(want[n], kLimit - 0.5);
  }
  EXPECT_GT(stopped, kCount / 10);
  ASSERT_TRUE(run.finite);
  for (std::size_t n = 0; n < kCount; ++n) {
    // Some roundings of 1e-16; the ride's first second is so small that it starts from rest.
    ASSERT_NEAR(run.prediction[n], 0.5 + want[n], 1e-12) << n;
  }
}

// A level of the input that would hold the output beyond: before the stretch it rests at the stop.
TEST(LoopTest, AStretchMayBeginAtTheStop) {
  const Body body{{{0.0, 0.1}}, {1.0, -0.9}};
  const Signals signals =
      made::signals_of(std::vector<double>(kCount, 2.0), made::white(kCount, 2));
  const FreeRun run = free_run(
      made::model_of(body,
                     {{"output_saturation", "stop above", {}, {constant("limit", "N", 1.5)}, {}}}),
      signals);
  for (std::size_t n = 0; n < kCount; ++n) ASSERT_NEAR(run.prediction[n], 1.5, 1e-9) << n;
}

// A spring within its straight part.  Inside, at rest: z = N u / (A - M), y = (B u + E z) / A.  Of
// the output: y = B u / (A + its own stiffness, 2/50).  A(1) = 0.2, B(1) = 0.12 and 0.2, N = 0.02,
// M = 0.04, E = 0.1.
TEST(LoopTest, ASpringRestsWhereTheForcesAgreeInEveryStretch) {
  std::vector<double> u(kCount, 3.0);
  std::vector<double> w(kCount, 1.0);
  std::fill(u.begin() + 1000, u.end(), -1.0);
  std::fill(w.begin() + 1000, w.end(), 2.0);
  const Measurement measurement = made::cut_in_two(
      made::measurement_of({{"u", "V", u}, {"w", "V", w}, {"y", "N", made::white(kCount, 2)}}),
      1000, 5.0);
  const auto run_of = [&](const Effect& spring) {
    Model model =
        made::model_of({{{0.0, 0.1, 0.02}, {0.3, -0.1, 0.0}}, {1.0, -1.2, 0.4}}, {spring});
    model.inputs = {"u", "w"};
    return free_run(model, Signals(measurement, {"u", "w"}, "y"));
  };
  const FreeRun inside = run_of(
      {"dead_zone", "play inside the body", {}, {}, {0.1, 0.3, 0.0, 0.02, 0.1, 0.0, 0.04, 0.2}});
  const FreeRun of_output = run_of(
      {"dead_zone", "play of the output", {}, {constant("threshold", "N", 50.0)}, {-2.0, 0.7}});
  for (std::size_t n = 0; n < kCount; ++n) {
    const double z = 0.02 * u[n] / (0.2 - 0.04);
    ASSERT_NEAR(inside.body[n], (0.12 * u[n] + 0.2 * w[n] + 0.1 * z) / 0.2, 1e-9) << n;
    ASSERT_NEAR(inside.argument[n], z, 1e-9) << n;
    ASSERT_NEAR(inside.phi[n], z, 1e-9) << n;
    const double y = (0.12 * u[n] + 0.2 * w[n]) / (0.2 + 2.0 / 50.0);
    ASSERT_NEAR(of_output.body[n], y, 1e-9) << n;
    ASSERT_NEAR(of_output.argument[n], y, 1e-9) << n;
    ASSERT_NEAR(of_output.phi[n], y / 50.0, 1e-9) << n;
  }
}

// A start for a fit: where a body has other poles, an effect keeps as many differences as it can.
TEST(LoopTest, AnEffectFitsABodyOfAnotherOrder) {
  const Effect inside{"asymmetry", "slopes inside the body", {}, {}, {1, 2, 3, 4, 5, 6, 7, 8}};
  const Effect higher = at_order(inside, 2, 3);
  EXPECT_EQ(higher.coefficients, (std::vector<double>{1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 0}));
  EXPECT_EQ(at_order(higher, 3, 2).coefficients, inside.coefficients);
  const Effect of_output{"asymmetry", "slopes of the output", {}, {}, {1, 2}};
  EXPECT_EQ(at_order(of_output, 2, 4).coefficients, (std::vector<double>{1, 2, 0, 0}));
  const Effect path{"coupled_input", "through the body", {"theta"}, {}, {1, 2, 3}};
  EXPECT_EQ(at_order(path, 2, 1).coefficients, (std::vector<double>{1, 2}));
  const Effect term{"coupled_input", "static", {"theta"}, {}, {1}};
  EXPECT_EQ(at_order(term, 2, 1).coefficients, term.coefficients);
}

}  // namespace stillhand::diagnosis::loop_test
