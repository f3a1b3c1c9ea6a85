// SPDX-License-Identifier: Apache-2.0
// Shapes that no named kind has, as the whole search finds them, and what a curve is beyond its
// knots.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <tuple>

#include "services/core/diagnosis/diagnose.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::free_form_test {

constexpr std::size_t kCount = 6000;

struct Recorded {
  std::vector<double> u = made::ride(kCount, 1);
  std::vector<double> theta = made::ride(kCount, 2, 0.1, 1.0);
  std::vector<double> noise = made::white(kCount, 3);
  std::vector<double> y = made::answer(made::two_pole_body(), u);

  [[nodiscard]] Diagnosis diagnosed(double noise_n, std::size_t most_effects = 4) const {
    std::vector<double> with_noise = y;
    for (std::size_t n = 0; n < kCount; ++n) with_noise[n] += noise_n * noise[n];
    DiagnoseOptions options;
    options.inputs = {"u"};
    options.output = "y";
    options.search.most_effects = most_effects;
    return diagnose(
        made::measurement_of({{"u", "m/s^2", u}, {"theta", "rad", theta}, {"y", "N", with_noise}}),
        options);
  }
};

// Numbers of a found curve: knots, and heights with that of the centre put in.
struct FoundCurve {
  explicit FoundCurve(const Effect& effect, double at_centre) {
    heights = effect.coefficients;
    for (const Parameter& parameter : effect.parameters) {
      if (parameter.name.starts_with("knot_")) knots.push_back(parameter.value);
      if (parameter.name.starts_with("change_")) heights.push_back(1.0 + parameter.value);
    }
    heights.insert(heights.begin() + static_cast<std::ptrdiff_t>(knots.size() / 2), at_centre);
  }
  std::vector<double> knots;
  std::vector<double> heights;
};

// A spring that the stick meets on one side alone.  The curve is straight between knots, the
// spring bends between two of them and goes on rising beyond the last one: 15 % of the largest
// force.  A constant force belongs to the model's offset, not to the curve.  One effect: a ripple
// would take what the bend leaves.
TEST(FreeFormTest, AForceOverAPosition) {
  Recorded sut;
  const auto spring = [](double x) { return 0.5 * std::max(0.0, x - 0.8); };
  for (std::size_t n = 0; n < kCount; ++n) sut.y[n] += spring(sut.theta[n]);
  const Diagnosis found = sut.diagnosed(0.05, 1);
  ASSERT_FALSE(found.effects.empty());
  const Effect& effect = found.model.effects.front();
  ASSERT_EQ(effect.kind, "free_form") << effect.form;
  EXPECT_EQ(effect.form, "force over a channel");
  EXPECT_EQ(found.effects.front().channel, "theta");
  const FoundCurve curve(effect, 0.0);
  const double largest = spring(curve.knots.back());
  double level = 0.0;
  for (std::size_t k = 0; k < curve.knots.size(); ++k) {
    level += (curve.heights[k] - spring(curve.knots[k])) / static_cast<double>(curve.knots.size());
  }
  for (std::size_t k = 0; k < curve.knots.size(); ++k) {
    EXPECT_NEAR(curve.heights[k] - level, spring(curve.knots[k]), 0.15 * largest)
        << "at " << curve.knots[k];
  }
  EXPECT_LT(found.final_error.rmse, 0.8 * found.baseline_error.rmse);
}

// A valve: nothing below the level at which it opens, and more and more above it, to 1.6 of the
// steepest straight line.  No kind has this shape.
TEST(FreeFormTest, ACurveOfTheInput) {
  Recorded sut;
  const auto valve = [](double u) { return std::pow(std::max(0.0, u + 0.4), 1.6); };
  std::vector<double> acting = sut.u;
  for (double& u : acting) u = valve(u);
  sut.y = made::answer(made::two_pole_body(), acting);
  const Diagnosis found = sut.diagnosed(0.05 * made::rms_of(sut.y), 1);
  ASSERT_FALSE(found.effects.empty());
  const Effect& effect = found.model.effects.front();
  ASSERT_EQ(effect.kind, "free_form") << effect.form;
  EXPECT_EQ(effect.form, "curve of the input");
  const EffectKind& kind = effect_kind("free_form");
  const double open = kind.mapped(effect, 1.0) - kind.mapped(effect, -0.4);
  EXPECT_NEAR((kind.mapped(effect, -1.5) - kind.mapped(effect, -0.4)) / open, 0.0, 0.1);
  EXPECT_NEAR((kind.mapped(effect, 2.0) - kind.mapped(effect, -0.4)) / open,
              valve(2.0) / valve(1.0), 0.1);
}

// The hand gives way where the vibration of the last seconds is large.
TEST(FreeFormTest, AGainThatFollowsTheVibration) {
  Recorded sut;
  // The vibration comes and goes every 12 s, by a factor of four.
  for (std::size_t n = 0; n < kCount; ++n) {
    sut.u[n] *= std::exp2(std::sin(2.0 * std::numbers::pi * static_cast<double>(n) / 1200.0));
  }
  sut.y = made::answer(made::two_pole_body(), sut.u);
  double square = 1.0;
  for (std::size_t n = 0; n < kCount; ++n) {
    square += (sut.u[n] * sut.u[n] - square) * 0.005;  // 2 s at 100 Hz
    sut.y[n] /= 0.5 + 0.5 * std::sqrt(square);
  }
  const Diagnosis found = sut.diagnosed(0.05);
  ASSERT_FALSE(found.effects.empty());
  const Effect& effect = found.model.effects.front();
  ASSERT_EQ(effect.kind, "free_form") << effect.form;
  EXPECT_EQ(effect.form, "gain over the size of an input");
  const FoundCurve curve(effect, 1.0);
  EXPECT_GT(curve.heights.front(), 1.1);
  EXPECT_LT(curve.heights.back(), 0.9);
}

TEST(FreeFormTest, NoneIsAddedWhereNoEffectMayBe) {
  Recorded sut;
  for (std::size_t n = 0; n < kCount; ++n) sut.y[n] += 0.5 * std::max(0.0, sut.theta[n] - 0.8);
  EXPECT_TRUE(sut.diagnosed(0.05, 0).effects.empty());
}

// Two coefficients: -1 at the first knot, 2 at the last one, 0 at the centre.
Effect three_knots() {
  return {"free_form",
          "force over a channel",
          {"theta"},
          {constant("knot_1", "rad", -1.0), constant("knot_2", "rad", 0.0),
           constant("knot_3", "rad", 2.0)},
          {-1.0, 2.0}};
}

Signals signals_over(const std::vector<double>& theta) {
  return {made::measurement_of({{"u", "m/s^2", made::white(theta.size(), 5)},
                                {"theta", "rad", theta},
                                {"y", "N", made::white(theta.size(), 6)}}),
          {"u"},
          "y"};
}

TEST(FreeFormTest, ACurveIsLevelBeyondItsOuterKnots) {
  const Effect sut = three_knots();
  const std::vector<double> theta{-1e6, -1.0, -0.25, 0.0, 0.5, 2.0, 1e6};
  const Signals signals = signals_over(theta);
  Columns columns;
  effect_kind("free_form").terms(sut, signals, {}, columns);
  ASSERT_EQ(columns.size(), 2u);
  const double wanted[] = {-1.0, -1.0, -0.25, 0.0, 0.5, 2.0, 2.0};
  for (std::size_t n = 0; n < theta.size(); ++n) {
    EXPECT_DOUBLE_EQ(sut.coefficients[0] * columns[0][n] + sut.coefficients[1] * columns[1][n],
                     wanted[n]);
  }
}

// METHOD "Kinds": the shares of the samples that weigh, all but the first second, below each knot.
TEST(FreeFormTest, KnotsLieWhereTheirShareOfTheSamplesLiesBelow) {
  Recorded sut;
  std::vector<double> acting = sut.u;
  for (double& u : acting) u = std::max(u, -0.4);  // a valve, and a spring on one side
  sut.y = made::answer(made::two_pole_body(), acting);
  for (std::size_t n = 0; n < kCount; ++n) sut.y[n] += 0.5 * std::max(0.0, sut.theta[n] - 0.8);
  const made::Studied of(
      made::measurement_of({{"u", "m/s^2", sut.u}, {"theta", "rad", sut.theta}, {"y", "N", sut.y}}),
      2);
  std::set<std::string> forms;
  for (const Proposal& each : effect_kind("free_form").proposed(of.screening)) {
    const Effect& effect = each.effect;
    for (const Parameter& number : effect.parameters) {
      if (!number.name.starts_with("change_")) continue;
      EXPECT_EQ(std::pair(number.lower, number.upper), std::pair(-3.0, 3.0)) << effect.form;
    }
    std::vector<double> x = of.signals.at(effect.channels.back()).values;
    x.erase(x.begin(), x.begin() + 100);
    std::ranges::sort(x);
    std::vector<double> shares{0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99};
    if (effect.form == "curve of the input") shares = {0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0};
    if (effect.form == "gain over the size of an input") continue;
    forms.insert(effect.form);
    for (std::size_t k = 0; k < shares.size(); ++k) {
      const double below = shares[k] * static_cast<double>(x.size() - 1);
      EXPECT_EQ(effect.value(k), x[static_cast<std::size_t>(below)]) << effect.form << ", " << k;
    }
    if (effect.form != "curve of the input") continue;
    // At the middle knot u itself, one more held, the others within five times the knots' range.
    EXPECT_EQ(effect.value(7 + 3), effect.value(3));
    EXPECT_EQ(complexity(effect), 5u);
    for (std::size_t k = 7; k < 14; ++k) {
      const Parameter& height = effect.parameters[k];
      const double most = height.fitted ? 5.0 * (effect.value(6) - effect.value(0)) : 0.0;
      EXPECT_NEAR(height.upper - height.value, most, 1e-12) << k;
      EXPECT_NEAR(height.value - height.lower, most, 1e-12) << k;
    }
  }
  EXPECT_THAT(forms, testing::IsSupersetOf({"force over a channel", "curve of the input"}));
}

// Sizes of 1, then 3, fade by e^(-1/50) a sample in 0.5 s; a stretch of 2 starts from its own first
// second.  With these knots the gain is half the size.
TEST(FreeFormTest, TheSizeOfAnInputFadesWithItsMemory) {
  std::vector<double> u(600);
  for (std::size_t n = 0; n < 600; ++n) {
    u[n] = (n < 200 ? 1.0 : (n < 400 ? 3.0 : 2.0)) * (n % 2 == 0 ? 1.0 : -1.0);
  }
  const auto measurement = made::measurement_of({{"u", "V", u}, {"y", "N", made::white(600, 2)}});
  const Signals signals(made::cut_in_two(measurement, 400, 5.0), {"u"}, "y");
  std::vector<double> sut(600, 1.0);
  effect_kind("free_form")
      .gain(made::effect_of("free_form", "gain over the size of an input", {"u"},
                            {constant("memory", "s", 0.5), constant("knot_1", "V", 0.0),
                             constant("knot_2", "V", 2.0), constant("knot_3", "V", 4.0),
                             constant("change_1", "-", -1.0), constant("change_2", "-", 1.0)}),
            signals, sut);
  for (std::size_t n = 0; n < 600; ++n) {
    const double fading = 9.0 - 8.0 * std::exp(-(static_cast<double>(n) - 199.0) / 50.0);
    const double square = n < 200 ? 1.0 : (n < 400 ? fading : 4.0);
    ASSERT_NEAR(sut[n], 0.5 * std::sqrt(square), 1e-12) << n;
  }
}

// A model file may hold anything.
TEST(FreeFormTest, WhatNoSearchMadeIsRefused) {
  const Signals signals = signals_over(made::white(50, 7));
  const auto knot = [](const char* name, double at) { return constant(name, "rad", at); };
  Columns columns;
  const EffectKind& sut = effect_kind("free_form");
  EXPECT_THROW(
      sut.terms(
          {"free_form", "force over a channel", {}, {knot("knot_1", 0.0), knot("knot_2", 1.0)}, {}},
          signals, {}, columns),
      std::out_of_range);
  EXPECT_THROW(sut.terms(made::effect_of("free_form", "force over a channel", {"theta"},
                                         {knot("knot_1", 1.0), knot("knot_2", 1.0)}),
                         signals, {}, columns),
               std::out_of_range);
  const std::vector<Parameter> heights(3, constant("height_1", "-", 0.0));
  // A height too few, and knots that do not ascend.
  for (const double last : {2.0, 1.0, 0.5}) {
    Effect inside =
        made::effect_of("free_form", "curve inside the body", {},
                        {knot("knot_1", 0.0), knot("knot_2", 1.0), knot("knot_3", last)});
    inside.parameters.insert(inside.parameters.end(), heights.begin(),
                             heights.end() - (last > 1.0 ? 1 : 0));
    EXPECT_THROW(std::ignore = sut.feedback(inside), std::out_of_range);
  }
  std::vector<double> gain(50, 1.0);
  EXPECT_THROW(sut.gain(made::effect_of("free_form", "gain over the size of an input", {"u"},
                                        {constant("memory", "s", 0.0),
                                         knot("knot_1", 0.0),
                                         knot("knot_2", 1.0),
                                         {"change_1", "-", 0.1, -3.0, 3.0}}),
                        signals, gain),
               std::out_of_range);
}

// The report draws it, with the errors of the numbers that were fitted.
TEST(FreeFormTest, TheCurveNamesTheNumbersThatWereFitted) {
  const Signals signals = signals_over(made::white(50, 7));
  const auto force = effect_kind("free_form").curve(three_knots(), signals);
  ASSERT_TRUE(force);
  EXPECT_EQ(force->over, "theta");
  EXPECT_EQ(force->over_unit, "rad");
  EXPECT_FALSE(force->pure_number);
  EXPECT_EQ(force->heights, (std::vector<double>{-1.0, 0.0, 2.0}));
  EXPECT_EQ(force->fitted, (std::vector<std::optional<std::size_t>>{0, std::nullopt, 1}));
  Effect factor = three_knots();
  factor.form = "factor over a channel";
  factor.channels = {"u", "theta"};
  factor.coefficients = {-1.0, 0.5, 2.0};
  const auto of_factor = effect_kind("free_form").curve(factor, signals);
  EXPECT_EQ(of_factor->of, "factor on u");
  EXPECT_EQ(of_factor->per, "m/s^2");
  EXPECT_EQ(of_factor->fitted, (std::vector<std::optional<std::size_t>>{0, 1, 2}));
  EXPECT_FALSE(effect_kind("delay").curve({"delay", "of the input", {}, {}, {}}, signals));
}

// A form in words, with a height for each knot.
TEST(FreeFormTest, TheEvidenceGivesTheCurve) {
  const Effect sut = three_knots();
  EXPECT_EQ(effect_kind("free_form").evidence(sut),
            "no named kind has this shape; the force over theta is -1 at -1 rad, 0 at 0 rad, 2 at "
            "2 rad");
}

// Without a bend nothing but its ends can be held: a height between them would be rounding's
// choice.
TEST(FreeFormTest, AStraightCurveHoldsItsEndsAlone) {
  const std::vector<double> z = made::white(2000, 8);
  const auto sut = effect_kind("free_form").drawn_after(z, z, std::vector<double>(z.size(), 1.0));
  ASSERT_TRUE(sut);
  EXPECT_EQ(complexity(*sut), sut->parameters.size() / 2 - 2);
}

// (high + low + (high - low)) / 2 is rounded to more than high.
TEST(FreeFormTest, TheLastKnotIsTheLargestArgumentWhateverRoundingSays) {
  std::vector<double> z = made::white(500, 8);
  z.front() = -3.061892643803443;
  z.back() = 3.7701509331258065;
  for (double& each : z) each = std::clamp(each, z.front(), z.back());
  const auto sut = effect_kind("free_form").drawn_after(z, z, std::vector<double>(z.size(), 1.0));
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->parameters[sut->parameters.size() / 2 - 1].value, z.back());
}

// Fifteen knots at even steps where arguments are even; straight ends and the bend at 0 are held,
// the others may move by five times the range of 2.
TEST(FreeFormTest, ACurveHasFifteenKnotsAndHoldsThree) {
  constexpr std::size_t kArguments = 1401;
  std::vector<double> z(kArguments);
  std::vector<double> phi(kArguments);
  for (std::size_t n = 0; n < kArguments; ++n) {
    z[n] = (static_cast<double>(n) - 700.0) / 700.0;
    phi[n] = 2.0 * std::abs(z[n]);
  }
  const EffectKind& kind = effect_kind("free_form");
  const auto sut = kind.drawn_after(z, phi, std::vector<double>(kArguments, 1.0));
  ASSERT_TRUE(sut);
  ASSERT_EQ(sut->parameters.size(), 30u);
  for (std::size_t k = 0; k < 15; ++k) {
    const Parameter& height = sut->parameters[15 + k];
    EXPECT_NEAR(sut->value(k), (static_cast<double>(k) - 7.0) / 7.0, 2e-3) << "one sample";
    EXPECT_EQ(height.value, 2.0 * std::abs(sut->value(k)));
    EXPECT_EQ(sut->parameters[k].name, "knot_" + std::to_string(k + 1));
    EXPECT_EQ(height.name, "height_" + std::to_string(k + 1));
    const bool held = k == 0 || k == 7 || k == 14;
    EXPECT_NEAR(height.upper - height.value, held ? 0.0 : 10.0, 1e-12) << k;
    EXPECT_NEAR(height.value - height.lower, held ? 0.0 : 10.0, 1e-12) << k;
  }
  // Fourteen that weigh are too few for fifteen knots.
  z.resize(15);
  std::vector<double> weight(15, 1.0);
  EXPECT_TRUE(kind.drawn_after(z, z, weight));
  weight[3] = 0.0;
  EXPECT_FALSE(kind.drawn_after(z, z, weight));
}

// The slope at a knot is that of the parabola through it and its neighbours, so a parabola is its
// own smooth curve, between knots wherever they are; beyond them its tangents, of -6 and 4.
TEST(FreeFormTest, ASmoothCurveThroughAParabolaIsTheParabola) {
  Effect sut{"free_form", "curve of the input", {"u"}, {}, {}};
  const auto parabola = [](double x) { return (x - 1.0) * (x - 1.0); };
  const double knots[] = {-2.0, -1.0, 0.5, 3.0};
  for (const double x : knots) sut.parameters.push_back(constant("knot_", "V", x));
  for (const double x : knots) sut.parameters.push_back(constant("height_", "V", parabola(x)));
  Effect inside = sut;
  inside.form = "curve inside the body";
  const EffectKind& kind = effect_kind("free_form");
  const Nonlinearity law = kind.feedback(inside);
  LoopMemory memory;
  EXPECT_EQ(law.threshold, 1.0);
  for (const double x : {-3.0, -2.0, -1.7, -1.0, -0.3, 0.0, 0.5, 1.2, 2.9, 3.0, 4.0}) {
    const double want = x < -2.0 ? 15.0 : (x > 3.0 ? 8.0 : parabola(x));
    EXPECT_NEAR(kind.mapped(sut, x), want, 1e-14 * 15.0) << x;
    EXPECT_NEAR(law.phi(x, memory), want - 1.0, 1e-14 * 15.0) << x << ": none at rest";
  }
}

// Slopes at the inner knots: 1 - 1/3 (1) = 2/3 and 0 + 1 (2) = 2.  Between them Hermite's cubic,
// 1 + 2 (2/3 (t^3 - 2 t^2 + t) + 2 (t^3 - t^2)), t = (x - 1)/2.
TEST(FreeFormTest, BetweenKnotsASmoothCurveIsTheCubicOfItsSlopes) {
  Effect sut{"free_form", "curve of the input", {"u"}, {}, {}};
  for (const double x : {0.0, 1.0, 3.0, 4.0}) sut.parameters.push_back(constant("knot_", "V", x));
  for (const double y : {0.0, 1.0, 1.0, 4.0}) sut.parameters.push_back(constant("height_", "V", y));
  const EffectKind& kind = effect_kind("free_form");
  EXPECT_NEAR(kind.mapped(sut, 1.5), 1.0, 1e-15);
  EXPECT_NEAR(kind.mapped(sut, 2.0), 2.0 / 3.0, 1e-15);
  EXPECT_NEAR(kind.mapped(sut, 2.5), 0.5, 1e-15);
}

// Errors e of both signs wherever no knot is leave 0.2 of the deviation of the force, sqrt(1/3
// + e^2), at e = 0.12.
TEST(FreeFormTest, ACurveLeavesLessThanAFifthOfTheForce) {
  constexpr std::size_t kArguments = 1401;
  for (const double error : {0.115, 0.121}) {
    std::vector<double> z(kArguments);
    std::vector<double> phi(kArguments);
    for (std::size_t n = 0; n < kArguments; ++n) {
      z[n] = (static_cast<double>(n) - 700.0) / 700.0;
      phi[n] = z[n];
      // Knots lie at every hundredth or, by rounding, next to it.
      if (n % 100 > 1 && n % 100 < 99) phi[n] += n % 2 == 0 ? error : -error;
    }
    const auto sut =
        effect_kind("free_form").drawn_after(z, phi, std::vector<double>(kArguments, 1.0));
    EXPECT_EQ(sut.has_value(), error < 0.118) << error;
  }
}

TEST(FreeFormTest, AForceWithMemoryIsNoCurve) {
  const std::vector<double> z = made::ride(2000, 8);
  std::vector<double> late(z.size());
  std::copy(z.begin(), z.end() - 10, late.begin() + 10);
  EXPECT_FALSE(effect_kind("free_form").drawn_after(z, late, std::vector<double>(z.size(), 1.0)));
}

// A limit on one side: straight up to 0, level above.  Then slopes of 0.5, 1.5, 1.5, 0.5 and -0.5,
// either way up and about; a level curve has none.
TEST(FreeFormTest, TheEvidenceOfACurveInsideIsItsSlopes) {
  const auto said_of = [](const std::vector<double>& heights) {
    Effect sut{"free_form", "curve inside the body", {}, {}, {}};
    for (const double x : {-2.0, -1.0, 0.0, 1.0, 2.0}) {
      sut.parameters.push_back(constant("knot_", "-", x));
    }
    for (const double y : heights) sut.parameters.push_back(constant("height_", "-", y));
    return effect_kind("free_form").evidence(sut);
  };
  const auto slopes = [](const std::string& low, const std::string& high) {
    return "no named kind bends as the curve inside the body does; its low end has " + low +
           ", its high end " + high + " of its steepest slope";
  };
  EXPECT_EQ(said_of({-2.0, -1.0, 0.0, 0.0, 0.0}), slopes("100 %", "0 %"));
  EXPECT_EQ(said_of({0.0, 1.0, 3.0, 4.0, 4.0}), slopes("33 %", "-33 %"));
  EXPECT_EQ(said_of({0.0, -1.0, -3.0, -4.0, -4.0}), slopes("33 %", "-33 %"));
  EXPECT_EQ(said_of({4.0, 4.0, 3.0, 1.0, 0.0}), slopes("-33 %", "33 %"));
  EXPECT_EQ(said_of({1.0, 1.0, 1.0, 1.0, 1.0}), slopes("0 %", "0 %"));
  EXPECT_EQ(said_of({0.0, -1.0, -4.0, -5.0, -5.0}), slopes("0 %", "-25 %"));
}

}  // namespace stillhand::diagnosis::free_form_test
