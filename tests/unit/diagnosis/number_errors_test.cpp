// SPDX-License-Identifier: Apache-2.0
// Standard errors against what repeated experiments scatter, and what no record determines.
#include "services/core/diagnosis/fitting/number_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "services/core/diagnosis/fitting/fit.hpp"
#include "tests/unit/diagnosis/every_effect.hpp"

namespace stillhand::diagnosis::number_errors_test {

constexpr std::size_t kSamples = 4000;

// r(n) = 0.8 r(n-1) + e(n): a third of its power below 1 Hz.
std::vector<double> slow_noise(std::uint64_t seed) {
  std::vector<double> r = made::white(kSamples, seed);
  for (std::size_t n = 1; n < r.size(); ++n) r[n] += 0.8 * r[n - 1];
  return r;
}

// y = 2 u + 0.5 theta + noise; theta lies below 1 Hz.
struct Repeat {
  explicit Repeat(std::uint64_t seed) {
    Measurement measurement = made::every_channel(kSamples, 3);
    std::vector<double>& y = measurement.channels.back().values;
    const std::vector<double> noise = slow_noise(seed);
    for (std::size_t n = 0; n < y.size(); ++n) {
      y[n] = 2.0 * measurement.channels[0].values[n] + 0.5 * measurement.find("theta")->values[n] +
             0.3 * noise[n];
    }
    const Signals signals(measurement, {"u"}, "y");
    model =
        made::model_of({{{1.0}}, {1.0}, 0.0}, {{"coupled_input", "static", {"theta"}, {}, {0.1}}});
    fit(model, signals, make_blocks(signals));
    const NumberErrors errors(model, linearised(model, signals), signals);
    gain_error = errors.of_number(2);
    // gain over factor: a function of two numbers.
    ratio = ratio_of(model);
    ratio_error =
        errors.of([](const Model& each) { return std::vector<double>{ratio_of(each)}; }).front();
  }
  static double ratio_of(const Model& model) {
    return model.effects[0].coefficients[0] / model.body.numerators[0][0];
  }

  Model model;
  double gain_error = 0.0;
  double ratio = 0.0;
  double ratio_error = 0.0;
};

// 60 repeats: a scatter has a standard error of 1/sqrt(120) = 9 %; three of them, and 5 % for the
// noise model's own errors.  In white noise of this power theta's gain would scatter by a third of
// it: the autocorrelation 0.8^k adds up to 9.
TEST(NumberErrorsTest, TheyAreWhatRepeatedExperimentsScatterUnderSlowNoise) {
  constexpr int kRepeats = 60;
  double square = 0.0;
  double ratio_square = 0.0;
  double error = 0.0;
  double ratio_error = 0.0;
  for (std::uint64_t seed = 1; seed <= kRepeats; ++seed) {
    const Repeat sut(100 + seed);
    square += std::pow(sut.model.effects[0].coefficients[0] - 0.5, 2) / kRepeats;
    ratio_square += std::pow(sut.ratio - 0.25, 2) / kRepeats;
    error += sut.gain_error / kRepeats;
    ratio_error += sut.ratio_error / kRepeats;
  }
  EXPECT_NEAR(error / std::sqrt(square), 1.0, 0.32);
  EXPECT_NEAR(ratio_error / std::sqrt(ratio_square), 1.0, 0.32);
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
