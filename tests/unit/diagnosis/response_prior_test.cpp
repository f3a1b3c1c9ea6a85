// SPDX-License-Identifier: Apache-2.0
// What is assumed of the body where the input excites nothing, Eq. DG-67.
#include "services/core/diagnosis/fitting/response_prior.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "services/core/diagnosis/fitting/fit.hpp"
#include "services/core/signal/difference_model.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::response_prior_test {

constexpr double kRate_hz = 100.0;
const std::vector<ExcitedBand> kBands{{"u", 0.7, 2.0}};

Model model_of(std::vector<double> numerator, std::vector<double> denominator) {
  return made::model_of({{std::move(numerator)}, std::move(denominator)});
}

double gain_at(const Model& model, double frequency_hz) {
  return std::abs(signal::response_at({kRate_hz, model.body.numerators[0], model.body.denominator},
                                      frequency_hz));
}

const Model kAssumed = model_of({0.5, -0.4, 0.1}, {1.0, -1.5, 0.6});
const Model kOther = model_of({0.6, -0.3, 0.2}, {1.0, -1.4, 0.55});

TEST(ResponsePriorTest, TheBodyThatIsAssumedCostsNothing) {
  const ResponsePrior sut(kAssumed.body, kBands, kRate_hz, 0.3, 0.1);
  EXPECT_FALSE(sut.empty());
  EXPECT_EQ(sut.error(kAssumed), 0.0);
  EXPECT_GT(sut.error(kOther), 0.0);
}

// Next to a map the body is a multiple of the baseline's.
TEST(ResponsePriorTest, ABodyIsScaledToAnotherWithinTheBand) {
  Body times = kAssumed.body;
  for (double& b : times.numerators[0]) b *= -1.7;
  EXPECT_NEAR(scaled_to(times, kAssumed.body, kBands, kRate_hz).numerators[0][0],
              times.numerators[0][0], 1e-12);
  // Of another one the part in phase: no other factor comes nearer.
  const Body nearest = scaled_to(kOther.body, kAssumed.body, kBands, kRate_hz);
  const double factor = nearest.numerators[0][0] / kAssumed.body.numerators[0][0];
  const auto distance = [&](double times_of) {
    double sum = 0.0;
    for (int i = 0; i < 32; ++i) {
      const double at_hz = 0.7 + 1.3 * i / 31;
      const auto response = [&](const Model& model) {
        return signal::response_at({kRate_hz, model.body.numerators[0], model.body.denominator},
                                   at_hz);
      };
      sum += std::norm(response(kOther) - times_of * response(kAssumed));
    }
    return sum;
  };
  EXPECT_LT(distance(factor), distance(factor + 0.01));
  EXPECT_LT(distance(factor), distance(factor - 0.01));
}

TEST(ResponsePriorTest, WhereEveryFrequencyIsExcitedNothingIsAssumed) {
  const ResponsePrior sut(kAssumed.body, {{"u", 0.0, 0.5 * kRate_hz}}, kRate_hz, 0.3, 0.1);
  EXPECT_TRUE(sut.empty());
  EXPECT_EQ(sut.error(kOther), 0.0);
}

TEST(ResponsePriorTest, TheSquaresGrowWithTheNoise) {
  const ResponsePrior once(kAssumed.body, kBands, kRate_hz, 0.3, 0.1);
  const ResponsePrior twice(kAssumed.body, kBands, kRate_hz, 0.6, 0.1);
  EXPECT_NEAR(twice.error(kOther), 4.0 * once.error(kOther), 1e-9 * once.error(kOther));
}

// A gain that is a tenth of the one in the band too high everywhere: each of the lines outside of
// the band adds the noise's square.  Of 32 from 0.07 to 50 Hz, ln(714)/31 = 0.212 apart, those at
// 11 to 15 steps (0.72 to 1.68 Hz) lie within.
TEST(ResponsePriorTest, ATenthOfTheGainCostsTheNoiseOnEachLine) {
  const Model gain = model_of({2.0}, {1.0});
  const Model higher = model_of({2.2}, {1.0});
  const ResponsePrior sut(gain.body, kBands, kRate_hz, 0.3, 0.1);
  EXPECT_NEAR(sut.error(higher) / (0.3 * 0.3), 27.0, 1e-9);
}

// The products are those of the squares' derivative, here by differences of them.
void expect_derivatives(const ResponsePrior& sut, const Model& of) {
  const Eigen::VectorXd at = packed(of);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(at.size() + 1, at.size() + 1);
  sut.add(of, gram);
  EXPECT_NEAR(gram(at.size(), at.size()), sut.error(of), 1e-12 * sut.error(of));
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    constexpr double kStep = 1e-6;
    const auto error_at = [&](double step) {
      Eigen::VectorXd numbers = at;
      numbers[i] += step;
      Model model = of;
      unpack(numbers, model);
      return sut.error(model);
    };
    const double slope = (error_at(kStep) - error_at(-kStep)) / (2.0 * kStep);
    // Residual = assumed - response: d error / d number = -2 jacobian^T residual.
    EXPECT_NEAR(-2.0 * gram(i, at.size()), slope, 1e-5 * gram.diagonal().maxCoeff()) << i;
  }
}

TEST(ResponsePriorTest, TheColumnsAreTheDerivatives) {
  expect_derivatives({kAssumed.body, kBands, kRate_hz, 0.3, 0.1}, kOther);
}

// A path of a slow channel: its higher differences answer only what lies above the channel's band.
TEST(ResponsePriorTest, APathHasNoResponseAboveTheBandOfItsChannel) {
  std::vector<double> slow(4000);
  for (std::size_t n = 0; n < slow.size(); ++n) {
    slow[n] = std::sin(2.0 * std::numbers::pi * 0.5 * static_cast<double>(n) / kRate_hz);
  }
  const auto u = made::ride(slow.size(), 1);
  const Signals signals(made::measurement_of({{"u", "V", u}, {"v", "V", slow}, {"y", "N", u}}),
                        {"u"}, "y");
  Model path = made::model_of(made::two_pole_body(),
                              {{"coupled_input", "through the body", {"v"}, {}, {0.1, 0.2, 0.3}}});
  const ResponsePrior sut(path, signals, 0.3);
  ASSERT_FALSE(sut.empty());
  expect_derivatives(sut, path);
  const double before = sut.error(path);
  path.effects[0].coefficients[2] = 30.0;
  EXPECT_GT(sut.error(path), 100.0 * before);
}

// Sines of 0.7 to 2 Hz alone, RMS 1, with the phases of Schroeder.
std::vector<double> sines(std::size_t count) {
  std::vector<double> x(count, 0.0);
  for (int k = 7; k <= 20; ++k) {
    for (std::size_t n = 0; n < count; ++n) {
      x[n] += std::sin(2.0 * std::numbers::pi * 0.1 * k * static_cast<double>(n) / kRate_hz -
                       std::numbers::pi * k * k / 14.0);
    }
  }
  return made::scaled_to(std::move(x), 1.0);
}

// `factor` times the assumed response in noise as large as the input, fitted from the assumed body.
Model fitted(double factor, const ResponsePrior* prior) {
  constexpr std::size_t kCount = 6000;
  Measurement measurement =
      made::measurement_of({{"u", "V", sines(kCount)}, {"y", "N", made::white(kCount, 2)}});
  const std::vector<double> clean = free_run(kAssumed, Signals(measurement, {"u"}, "y")).prediction;
  std::vector<double>& y = measurement.channels.back().values;
  for (std::size_t n = 0; n < kCount; ++n) y[n] += factor * clean[n];
  const Signals signals(measurement, {"u"}, "y");
  Model model = kAssumed;
  const FitOptions options{.max_iterations = 50, .prior = prior};
  fit(model, signals, make_blocks(signals), options);
  return model;
}

TEST(ResponsePriorTest, WhatTheSamplesDoNotDetermineStaysAsItWasAssumed) {
  const ResponsePrior sut(kAssumed.body, kBands, kRate_hz, 1.0, 0.1);
  EXPECT_LT(sut.error(fitted(1.0, &sut)), 0.2 * sut.error(fitted(1.0, nullptr)));
}

TEST(ResponsePriorTest, WhatTheSamplesDetermineIsNotHeldBack) {
  const ResponsePrior sut(kAssumed.body, kBands, kRate_hz, 1.0, 0.1);
  EXPECT_NEAR(gain_at(fitted(1.2, &sut), 1.2), 1.2 * gain_at(kAssumed, 1.2),
              0.036 * gain_at(kAssumed, 1.2));
}

}  // namespace stillhand::diagnosis::response_prior_test
