// SPDX-License-Identifier: Apache-2.0
// Linear parts at the control rate, Eq. CL-1 and CL-2, against responses that are written out.
#include "apps/close_the_loop/verdict/control_response.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "services/core/contract/units.hpp"
#include "services/core/diagnosis/model/modes.hpp"
#include "services/core/signal/difference_model.hpp"

namespace stillhand::close_the_loop::control_response_test {
namespace {

using Complex = std::complex<double>;
using diagnosis::mode_denominator;
using diagnosis::product;

constexpr double kRateHz = 100.0;

diagnosis::Model model_of(std::vector<double> denominator, std::vector<double> numerator) {
  diagnosis::Model model;
  model.rate_hz = kRateHz;
  model.inputs = {"a_y"};
  model.output = "f";
  model.output_unit = "N";
  model.body.denominator = std::move(denominator);
  model.body.numerators = {std::move(numerator)};
  return model;
}

diagnosis::Model one_mode() {
  return model_of(mode_denominator(2.6, 0.25, kRateHz), {-0.02, -0.01, 0.01});
}

diagnosis::Effect resonance(double frequency_hz, std::vector<double> coefficients) {
  return {"resonance",
          "beside the body",
          {},
          {{"frequency", "Hz", frequency_hz, 0.1, 40.0}, {"damping_ratio", "-", 0.1, 0.0, 1.0}},
          std::move(coefficients)};
}

diagnosis::Effect delay(double delay_s) {
  return {"delay", "of the input", {}, {{"delay", "s", delay_s, -0.1, 0.5}}, {}};
}

// The definition, term by term.
Complex sum_of(const std::vector<double>& c, double turn_rad) {
  Complex sum = 0.0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    sum += c[i] * std::exp(Complex(0.0, -turn_rad * static_cast<double>(i)));
  }
  return sum;
}

TEST(ControlResponseTest, APolynomialIsTheSumOfItsTurns) {
  const std::vector<double> c{0.5, -1.25, 3.0, 0.0, 2.0};
  for (const double turn_rad : {0.0, 0.1, 1.0, std::numbers::pi, -2.0}) {
    EXPECT_LT(std::abs(polynomial_at(c, turn_rad) - sum_of(c, turn_rad)), 1e-14) << turn_rad;
  }
  EXPECT_EQ(polynomial_at({}, 1.0), Complex(0.0));
}

TEST(ControlResponseTest, TheBodysResponseIsItsDifferenceEquations) {
  diagnosis::Model model = one_mode();
  model.inputs.push_back("a_x");
  model.body.numerators.push_back({0.3, 0.0, -0.1});
  for (const double frequency_hz : {0.0, 0.5, 2.6, 20.0, 50.0}) {
    const double w = kTwoPi * frequency_hz / kRateHz;
    for (std::size_t k = 0; k < 2; ++k) {
      const Complex want = sum_of(model.body.numerators[k], w) / sum_of(model.body.denominator, w);
      EXPECT_LT(std::abs(body_response(model, k, frequency_hz) - want), 1e-12);
      EXPECT_EQ(mode_response(model, k, frequency_hz), Complex(0.0));
    }
  }
}

// c_0 (1 - q^-1) + c_1 over the mode, for each input its own pair.
TEST(ControlResponseTest, AModeNextToTheBodyHasAResponseOfItsOwn) {
  diagnosis::Model model = one_mode();
  model.inputs.push_back("a_x");
  model.body.numerators.push_back({0.3, 0.0, -0.1});
  model.effects = {resonance(7.0, {0.5, 0.02, -0.25, 0.04})};
  EXPECT_TRUE(has_modes(model));
  const auto mode = mode_denominator(7.0, 0.1, kRateHz);
  for (const double frequency_hz : {0.0, 3.0, 7.0, 30.0}) {
    const double w = kTwoPi * frequency_hz / kRateHz;
    const Complex difference = 1.0 - std::exp(Complex(0.0, -w));
    const Complex of_first = (0.5 * difference + 0.02) / sum_of(mode, w);
    const Complex of_second = (-0.25 * difference + 0.04) / sum_of(mode, w);
    EXPECT_LT(std::abs(mode_response(model, 0, frequency_hz) - of_first), 1e-12);
    EXPECT_LT(std::abs(mode_response(model, 1, frequency_hz) - of_second), 1e-12);
  }
}

// z' = z^(1/10): a mode keeps its frequency and its damping.  Roots of a quadratic to 1e-12.
TEST(ControlResponseTest, PolesKeepFrequencyAndDampingAtTheControlRate) {
  const auto sut = possible_denominators(one_mode()).front();
  const auto want = mode_denominator(2.6, 0.25, 1000.0);
  ASSERT_EQ(sut.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(sut[i], want[i], 1e-11) << i;
}

TEST(ControlResponseTest, EveryModeAddsItsTwoPoles) {
  diagnosis::Model model = one_mode();
  model.effects = {resonance(7.0, {0.1, 0.01}), resonance(12.0, {0.1, 0.01})};
  const auto sut = possible_denominators(model).front();
  const auto want =
      product(product(mode_denominator(2.6, 0.25, 1000.0), mode_denominator(7.0, 0.1, 1000.0)),
              mode_denominator(12.0, 0.1, 1000.0));
  ASSERT_EQ(sut.size(), want.size());
  for (std::size_t i = 0; i < want.size(); ++i) EXPECT_NEAR(sut[i], want[i], 1e-9) << i;
}

// A pole at -0.8 turns by half of 100 Hz and has no equal at 1 kHz; 0 has no logarithm.
TEST(ControlResponseTest, APoleWithoutAnEqualStillGivesAStableBody) {
  for (const double pole : {-0.8, 0.0, 1e-9}) {
    const auto model =
        model_of(product({1.0, -pole}, mode_denominator(3.0, 0.3, kRateHz)), {0.1, 0.02, 0.0, 0.0});
    for (const auto& denominator : possible_denominators(model)) {
      EXPECT_EQ(denominator.front(), 1.0) << pole;
      const signal::DifferenceModel sut{1000.0, denominator, denominator};
      ASSERT_TRUE(signal::well_formed(sut)) << pole;
      EXPECT_TRUE(signal::is_stable(sut)) << pole;
    }
  }
}

TEST(ControlResponseTest, AStaticBodyStaysStatic) {
  const auto sut = possible_denominators(model_of({1.0}, {-3.2}));
  EXPECT_EQ(sut.front(), std::vector<double>{1.0});
}

TEST(ControlResponseTest, TheInputsDelayIsThatOfItsEffect) {
  diagnosis::Model model = one_mode();
  EXPECT_EQ(input_delay_s(model), 0.0);
  model.effects = {resonance(7.0, {0.1, 0.01})};
  EXPECT_EQ(input_delay_s(model), 0.0);
  model.effects.push_back(delay(0.0371));
  EXPECT_EQ(input_delay_s(model), 0.0371);
  model.effects = {delay(-0.01)};
  EXPECT_EQ(input_delay_s(model), -0.01) << "a sensor of the input may be late";
}

// Two clocks that run apart are not the input's delay: the canceller has one clock.
TEST(ControlResponseTest, AClockDriftIsNoDelay) {
  diagnosis::Model model = one_mode();
  model.effects = {
      {"clock_drift", "", {}, {{"drift", "us/s", 900.0}, {"reference_time", "s", -50.0}}, {}}};
  EXPECT_EQ(input_delay_s(model), 0.0);
}

// A response that lies in the set of numerators is met to rounding: columns of (1 - q^-1)^i differ
// in size by (2 pi 10/1000)^2 = 4e-3 and are scaled, so 1e-16 grows by some thousand.
TEST(ControlResponseTest, ANumeratorThatExistsIsFound) {
  const auto denominator = mode_denominator(2.6, 0.25, 1000.0);
  const std::vector<double> truth{-0.02, 0.03, -0.0105};
  const Response wanted = [&](double frequency_hz) {
    const double w = kTwoPi * frequency_hz / 1000.0;
    return sum_of(truth, w) / sum_of(denominator, w);
  };
  const NumeratorFit sut = fit_numerator(denominator, wanted, false, {});
  EXPECT_LT(sut.error, 1e-9);
  ASSERT_EQ(sut.numerator.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(sut.numerator[i], truth[i], 1e-7) << i;
}

TEST(ControlResponseTest, ALateNumeratorHasNoTermOfItsOwnSample) {
  const auto denominator = mode_denominator(2.6, 0.25, 1000.0);
  const std::vector<double> truth{0.0, 0.03, -0.0305};
  const Response wanted = [&](double frequency_hz) {
    const double w = kTwoPi * frequency_hz / 1000.0;
    return sum_of(truth, w) / sum_of(denominator, w);
  };
  const NumeratorFit sut = fit_numerator(denominator, wanted, true, {});
  ASSERT_EQ(sut.numerator.size(), 3u);
  EXPECT_EQ(sut.numerator[0], 0.0);
  EXPECT_LT(sut.error, 1e-9);
}

// Least squares is linear, and the error relative.
TEST(ControlResponseTest, AResponseTenTimesAsLargeHasTenTimesTheNumeratorAndTheSameError) {
  const auto denominator = mode_denominator(2.6, 0.25, 1000.0);
  const auto response = [](double scale) {
    return [scale](double frequency_hz) {
      return scale * std::polar(1.0, -kTwoPi * frequency_hz * 0.05);
    };
  };
  const NumeratorFit once = fit_numerator(denominator, response(1.0), false, {});
  const NumeratorFit sut = fit_numerator(denominator, response(10.0), false, {});
  EXPECT_GT(once.error, 0.01) << "three coefficients are no delay of 50 ms";
  EXPECT_NEAR(sut.error, once.error, 1e-9);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(sut.numerator[i], 10.0 * once.numerator[i], 1e-7 * std::abs(sut.numerator[i]));
  }
}

TEST(ControlResponseTest, NothingIsMetWithoutAnError) {
  const Response nothing = [](double) { return Complex(0.0); };
  const NumeratorFit sut = fit_numerator({1.0, -0.9}, nothing, false, {});
  EXPECT_EQ(sut.error, 0.0);
  for (const double c : sut.numerator) EXPECT_EQ(c, 0.0);
}

// What lies outside the band is met with less weight and does not count in the error: a response
// that is 1 in the band and 0 above it.
TEST(ControlResponseTest, TheErrorIsThatOfTheBand) {
  ControlOptions options{.low_hz = 0.5, .high_hz = 1.0};
  const Response shelf = [](double frequency_hz) {
    return Complex(frequency_hz < 4.0 ? 1.0 : 0.0);
  };
  const NumeratorFit narrow =
      fit_numerator(mode_denominator(3.0, 0.7, 1000.0), shelf, false, options);
  options.high_hz = 10.0;
  const NumeratorFit wide =
      fit_numerator(mode_denominator(3.0, 0.7, 1000.0), shelf, false, options);
  EXPECT_LT(narrow.error, wide.error);
  EXPECT_GT(wide.error, 0.3) << "a step of 1 between two lines is missed by a third at least";
}

}  // namespace
}  // namespace stillhand::close_the_loop::control_response_test
