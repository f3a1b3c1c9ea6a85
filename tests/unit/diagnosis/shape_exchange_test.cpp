// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/shape_exchange.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "tests/support/rms_share.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::shape_exchange_test {

constexpr std::size_t kCount = 3001;

class ShapeExchangeTest : public ::testing::Test {
 protected:
  // N = B and M = E = q^-1 stiffness / threshold in DG-4: z is the body's own output over the
  // threshold, so the structure is one that a spring can have.
  [[nodiscard]] Model sprung(const Effect& effect, double stiffness, double threshold) const {
    Model model = made::model_of(made::two_pole_body(), {effect});
    const double force = stiffness * threshold;
    // E by powers of D: q^-1 = 1 - D.
    std::vector<double> numbers{force, -force, 0.0};
    std::vector<double> n = model.body.numerators[0];
    for (double& each : n) each /= threshold;
    n = difference_basis(n);
    numbers.insert(numbers.end(), n.begin(), n.end());
    numbers.insert(numbers.end(), {stiffness, 0.0});
    model.effects.back().coefficients = numbers;
    return model;
  }

  [[nodiscard]] std::vector<double> run(const Model& model) const {
    const FreeRun free = free_run(model, signals_);
    EXPECT_TRUE(free.finite);
    return free.prediction;
  }

  // RMS of the difference over what the nonlinearity does to the first.
  [[nodiscard]] double difference(const Model& sut, const Model& of) const {
    Model linear = of;
    linear.effects.clear();
    const auto a = run(sut);
    const auto b = run(of);
    const auto without = run(linear);
    support::RmsShare share;
    for (std::size_t n = 0; n < a.size(); ++n) share.add(a[n] - b[n], b[n] - without[n]);
    return share.value();
  }

  [[nodiscard]] Effect play_with(double threshold) const {
    Effect play = play_;
    play.parameters = {constant("threshold", "-", threshold)};
    return play;
  }

  Signals signals_ = made::signals_of(made::ride(kCount, 1), made::white(kCount, 2));
  Effect play_{"dead_zone", "play inside the body", {}, {}, {}};
  Effect levelled_{"nonlinear_stiffness", "levelled inside the body", {}, {}, {}};
  Effect bent_{"nonlinear_stiffness", "bent inside the body", {}, {}, {}};
  Effect slopes_{"asymmetry", "slopes inside the body", {}, {}, {}};
  Effect cubic_{"nonlinear_stiffness", "cubic inside the body", {}, {}, {}};
  double size_ = made::rms_of(made::answer(made::two_pole_body(), made::ride(kCount, 1)));
};

// With its threshold elsewhere the law is the same at another scale of z: from a quarter to four.
TEST_F(ShapeExchangeTest, TheSameShapeIsTheSameModelAtEachScale) {
  const Model model = sprung(play_, -0.02, size_);
  for (const double scale : {0.25, 0.5, 0.7, 1.0, 1.4, 2.0, 4.0}) {
    const auto sut = with_shape_of(play_with(1.0 / scale), model, signals_);
    ASSERT_TRUE(sut) << scale;
    EXPECT_LT(difference(*sut, model), 1e-12) << scale;
  }
  // A curve's scales are a fifth apart, from 1.2^-14 to 1.2^14.
  for (const int fifths : {-14, 1, 14}) {
    EXPECT_LT(read_as(play_with(std::pow(1.2, -fifths)), model, signals_).unread, 1e-12) << fifths;
  }
}

// z^3/(1 + z^2) is z^3 but for a share of z^2; thresholds 20 times the motion: z^2 is 0.0025.
TEST_F(ShapeExchangeTest, SpringsThatAreAlikeAtSmallAmplitudesRunAlike) {
  const Model model = sprung(cubic_, -0.5, 20.0 * size_);
  const auto sut = with_shape_of(bent_, model, signals_);
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->effects.back().form, bent_.form);
  EXPECT_LT(difference(*sut, model), 0.0025);
}

// Eq. DG-49: play, clip(z), isn't z - tanh(z), but nearly a multiple of it and of z.  In its place
// with the same numbers the levelled spring is off by a good part of what play does.
TEST_F(ShapeExchangeTest, ThePartThatIsLinearMovesIntoTheBody) {
  const Model model = sprung(play_, -0.05, 0.7 * size_);
  const auto sut = with_shape_of(levelled_, model, signals_);
  ASSERT_TRUE(sut);
  Model in_place = model;
  in_place.effects.back().kind = levelled_.kind;
  in_place.effects.back().form = levelled_.form;
  EXPECT_LT(difference(*sut, model), 0.05);
  EXPECT_GT(difference(in_place, model), 0.3);
}

TEST_F(ShapeExchangeTest, ALiftedModelRunsAsBefore) {
  const Model model = sprung(levelled_, -0.05, size_);
  const Model sut = lifted(model);
  EXPECT_EQ(sut.body.order(), model.body.order() + 1);
  EXPECT_LT(difference(sut, model), 1e-9);
}

TEST_F(ShapeExchangeTest, OnlyANonlinearityInsideTheBodyIsOne) {
  Model model = sprung(play_, -0.02, size_);
  EXPECT_TRUE(ends_inside_body(model));
  model.effects.push_back({"coupled_input", "static", {"u"}, {}, {1.0}});
  EXPECT_FALSE(ends_inside_body(model));
  model.effects.clear();
  EXPECT_FALSE(ends_inside_body(model));
}

// Eq. DG-90, wherever the threshold lies: the scale of z is the fit's.  Far out, where few samples
// are, fifteen knots round the corners off by more.
TEST_F(ShapeExchangeTest, ACurveIsReadByTheLawThatDrewIt) {
  for (const double threshold : {0.4, 0.55, 0.7, 0.85, 1.0}) {
    const Model model = sprung(play_, -0.05, threshold * size_);
    const FreeRun of_law = free_run(model, signals_);
    const auto curve =
        effect_kind("free_form").drawn_after(of_law.argument, of_law.phi, signals_.weight());
    ASSERT_TRUE(curve) << threshold;
    const auto sut = with_shape_of(*curve, model, signals_);
    ASSERT_TRUE(sut) << threshold;
    const Reading by_own = read_as(play_, *sut, signals_);
    EXPECT_LT(by_own.unread, 0.08) << threshold;
    ASSERT_TRUE(by_own.model) << threshold;
    EXPECT_EQ(by_own.model->effects.back().kind, "dead_zone");
    EXPECT_LT(difference(*by_own.model, *sut), 0.02) << threshold;
    EXPECT_GT(read_as(slopes_, *sut, signals_).unread, 0.95) << threshold;
  }
}

}  // namespace stillhand::diagnosis::shape_exchange_test
