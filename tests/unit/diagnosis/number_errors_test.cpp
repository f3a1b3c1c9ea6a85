// SPDX-License-Identifier: Apache-2.0
// Standard errors in their closed form, and what no record determines; planted_sizes_test.cpp has
// what repeated experiments scatter.
#include "services/core/diagnosis/fitting/number_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "services/core/diagnosis/fitting/fit.hpp"
#include "services/core/diagnosis/fitting/noise_model.hpp"
#include "tests/unit/diagnosis/every_effect.hpp"

namespace stillhand::diagnosis::number_errors_test {

constexpr std::size_t kSamples = 4000;

// Under r(n) = 0.8 r(n-1) + e(n), X the weighted columns of offset, u and theta: Eq. DG-70 with the
// taps C of the noise model, each stretch by itself, X'X^-1 X' C^-1 C^-T X X'X^-1 times what is
// left.
TEST(NumberErrorsTest, TheyAreThoseOfTheNoisesCovariance) {
  constexpr std::size_t kRows = 401;
  Measurement measurement = made::every_channel(kRows, 3);
  const auto noise = made::answer({1.0}, {1.0, -0.8}, made::white(kRows, 7));
  measurement.channels.back().values = made::mix({{2.0, measurement.channels[0].values},
                                                  {0.5, measurement.find("theta")->values},
                                                  {0.3, noise}});
  const Signals signals(made::cut_in_two(measurement, 180, 5.0), {"u"}, "y");
  Model model =
      made::model_of({{{1.0}}, {1.0}, 0.0}, {{"coupled_input", "static", {"theta"}, {}, {0.1}}});
  fit(model, signals, make_blocks(signals));
  const Linearisation line = linearised(model, signals);
  const NumberErrors sut(model, line, signals);
  const std::vector<double> taps = noise_taps(line.residual, signals);
  ASSERT_GT(taps.size(), 1u);
  Eigen::MatrixXd x(kRows, 3);
  x << made::column_of(std::vector<double>(kRows, 1.0)), made::column_of(signals.at("u").values),
      made::column_of(signals.at("theta").values);
  const Eigen::VectorXd weight = made::column_of(signals.weight());
  x.array().colwise() *= weight.array();
  Eigen::MatrixXd filter = Eigen::MatrixXd::Zero(kRows, kRows);
  for (Eigen::Index n = 0; n < filter.rows(); ++n) {
    for (Eigen::Index k = 0; k < std::ssize(taps) && k <= (n < 180 ? n : n - 180); ++k) {
      filter(n, n - k) = taps[static_cast<std::size_t>(k)];
    }
  }
  const Eigen::MatrixXd spread = filter.transpose().triangularView<Eigen::Upper>().solve(
      Eigen::MatrixXd(x * (x.transpose() * x).inverse()));
  const Eigen::MatrixXd want =
      line.residual.squaredNorm() / (weight.sum() - 3.0) * (spread.transpose() * spread);
  for (const Eigen::Index i : {0, 1, 2}) {
    EXPECT_NEAR(sut.of_number(static_cast<std::size_t>(i)) / std::sqrt(want(i, i)), 1.0, 1e-6);
  }
  // Gain over factor: a function of two numbers, by its gradient.
  const double factor = model.body.numerators[0][0];
  const double gain = model.effects[0].coefficients[0];
  const Eigen::Vector3d gradient(0.0, -gain / (factor * factor), 1.0 / factor);
  const double ratio_error =
      sut.of([](const Model& each) {
           return std::vector<double>{each.effects[0].coefficients[0] / each.body.numerators[0][0]};
         })
          .front();
  EXPECT_NEAR(ratio_error / std::sqrt(gradient.dot(want * gradient)), 1.0, 1e-5);
}

// c z^3 with z from any numerator N: a larger N and a smaller c are the same model.
TEST(NumberErrorsTest, ADirectionThatChangesNothingHasNoError) {
  Measurement measurement = made::every_channel(kSamples, 5);
  Model model =
      made::model_of(made::two_pole_body(),
                     {made::effect_of("nonlinear_stiffness", "cubic inside the body", {}, {},
                                      {0.02, -0.01, 0.005, 0.04, 0.01, 0.0, -0.001, 0.002})});
  std::vector<double>& y = measurement.channels.back().values;
  y = free_run(model, Signals(measurement, {"u"}, "y")).prediction;
  const std::vector<double> noise = made::white(kSamples, 9);
  for (std::size_t n = 0; n < y.size(); ++n) y[n] += 0.01 * noise[n];
  const Signals signals(measurement, {"u"}, "y");
  const NumberErrors sut(model, linearised(model, signals), signals);
  // offset, 3 of B, 2 of A, then E, N, M.
  constexpr std::size_t kFirstOfN = 9;
  EXPECT_TRUE(std::isnan(sut.of_number(kFirstOfN)));
  EXPECT_GT(sut.of_number(1), 0.0);
  const double error = sut.of([](const Model& each) {
                            const auto& c = each.effects[0].coefficients;
                            return std::vector<double>{c[0] * std::pow(c[3], 3)};
                          })
                           .front();
  EXPECT_GT(error, 0.0) << "the product does not change with the scale";
}

TEST(NumberErrorsTest, ARecordWithoutSamplesToSpareDeterminesNothing) {
  const Signals signals(made::every_channel(kSamples, 6), {"u"}, "y");
  const Model model = made::model_of(made::two_pole_body());
  Linearisation line = linearised(model, signals);
  line.finite = false;
  EXPECT_TRUE(std::isnan(NumberErrors(model, line, signals).of_number(0)));
}

}  // namespace stillhand::diagnosis::number_errors_test
