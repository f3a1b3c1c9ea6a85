// SPDX-License-Identifier: Apache-2.0
// A curve between two bodies, and what the search makes of it.
#include "services/core/diagnosis/fitting/cascade.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/core/diagnosis/diagnose.hpp"
#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/fitting/shape_exchange.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::cascade_test {

constexpr std::size_t kCount = 6000;

std::vector<double> standardised(std::vector<double> x) { return made::scaled_to(x, 1.0); }

// Three poles, a curve, three poles, with noise of `noise` of the output.
template <class Curve>
Measurement made_cascade(const Curve& curve, double noise) {
  const std::vector<double> u = made::ride(kCount, 1);
  std::vector<double> z = standardised(
      made::answer({0.0, 0.3, 0.1}, made::times(made::mode(6.0, 0.4), {1.0, -0.6}), u));
  for (double& each : z) each = curve(each);
  std::vector<double> y = standardised(
      made::answer({0.2, -0.1, 0.1}, made::times(made::mode(2.5, 0.35), {1.0, -0.8}), z));
  const std::vector<double> white = made::white(kCount, 3);
  for (std::size_t n = 0; n < kCount; ++n) y[n] += noise * white[n];
  return made::measurement_of({{"u", "m/s^2", u}, {"y", "N", y}});
}

// As a diode at its supply: a straight line that bends to another one, with a smooth knee.
double limited(double z) { return z < 0.4 ? z : 0.4 + 0.5 * std::tanh((z - 0.4) / 0.5); }

Diagnosis diagnosed(const Measurement& measurement) {
  DiagnoseOptions options;
  options.inputs = {"u"};
  options.output = "y";
  options.search.most_effects = 1;
  return diagnose(measurement, options);
}

// METHOD Eq. DG-91, from poles that are a tenth wrong.
TEST(CascadeTest, FindsTheCurveBetweenTwoBodies) {
  const Signals signals(made_cascade(limited, 0.001), {"u"}, "y");
  Body body;
  body.denominator = made::times(made::times(made::mode(6.6, 0.36), {1.0, -0.54}),
                                 made::times(made::mode(2.25, 0.39), {1.0, -0.88}));
  body.numerators = {std::vector<double>(7, 0.0)};
  Effect law{"asymmetry", "slopes inside the body", {}, {}, std::vector<double>(20, 0.0)};
  const auto sut = cascade(made::model_of(body, {law}), free_form_kind(), signals);
  ASSERT_TRUE(sut);
  FreeRun run;
  const Eigen::VectorXd residual = residual_of(*sut, signals, run);
  EXPECT_TRUE(run.finite);
  EXPECT_LT(std::sqrt(residual.squaredNorm() / kCount), 0.0011);  // the noise is 0.001
  EXPECT_EQ(sut->effects.back().form, "curve inside the body");
}

TEST(CascadeTest, TheSearchDrawsAShapeThatNoLawHas) {
  const Diagnosis found = diagnosed(made_cascade(limited, 0.01));
  ASSERT_FALSE(found.effects.empty());
  const Effect& effect = found.model.effects.front();
  EXPECT_EQ(effect.kind, "free_form");
  EXPECT_EQ(effect.form, "curve inside the body");
  EXPECT_LT(found.final_error.rmse, 0.011);  // the noise is 0.01
  EXPECT_TRUE(std::holds_alternative<control::Spring>(free_form_kind().body_role(effect)));
}

// The curve only leads to the poles: a law that has its shape gets the name.
TEST(CascadeTest, ALawThatHasTheShapeKeepsItsName) {
  const auto sloped = [](double z) { return z + 0.5 * std::abs(z); };
  const Diagnosis found = diagnosed(made_cascade(sloped, 0.01));
  ASSERT_FALSE(found.effects.empty());
  EXPECT_EQ(found.model.effects.front().kind, "asymmetry");
  EXPECT_LT(found.final_error.rmse, 0.011);
}

}  // namespace stillhand::diagnosis::cascade_test
