// SPDX-License-Identifier: Apache-2.0
// Physical numbers by their closed forms.
#include "services/core/diagnosis/effect_sizes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "services/core/diagnosis/model/loop.hpp"
#include "tests/unit/diagnosis/every_effect.hpp"

namespace stillhand::diagnosis::effect_sizes_test {

constexpr std::size_t kSamples = 2000;

// What a diagnosis has of one effect next to a body with two poles.
struct Sized {
  explicit Sized(const Effect& effect, Body body = made::two_pole_body())
      : model(made::model_of(std::move(body), {effect})),
        signals(made::every_channel(kSamples, 11), {"u"}, "y"),
        line(linearised(model, signals)),
        at(size_case(model, 0, signals, line.run)),
        sizes(effect_sizes(at, NumberErrors(model, line, signals))) {}
  Sized(const Sized&) = delete;
  Sized& operator=(const Sized&) = delete;

  [[nodiscard]] const Size& named(const std::string& name) const {
    const auto found = std::ranges::find(sizes, name, &Size::name);
    if (found == sizes.end()) throw std::out_of_range(name);
    return *found;
  }
  [[nodiscard]] double value(const std::string& name) const { return named(name).value; }

  Model model;
  Signals signals;
  Linearisation line;
  SizeCase at;
  std::vector<Size> sizes;
};

double at_rest(const std::vector<double>& c) {
  double sum = 0.0;
  for (const double each : c) sum += each;
  return sum;
}

const std::vector<double> kDenominator = made::two_pole_body().denominator;

TEST(EffectSizesTest, EveryFormHasFiniteNumbersWithDifferentNamesAndUnits) {
  for (const Effect& effect : made::every_effect()) {
    SCOPED_TRACE(effect.kind + ", " + effect.form);
    const Sized sut(effect);
    EXPECT_FALSE(sut.sizes.empty());
    std::set<std::string> names;
    for (const Size& size : sut.sizes) {
      EXPECT_TRUE(names.insert(size.name).second) << size.name;
      EXPECT_TRUE(std::isfinite(size.value)) << size.name;
      EXPECT_FALSE(size.unit.empty()) << size.name;
      EXPECT_FALSE(size.std_error < 0.0) << size.name;
      const bool chosen = size.origin == "searched" || size.origin == "given";
      EXPECT_TRUE(!chosen || std::isnan(size.std_error)) << size.name;
    }
  }
}

TEST(EffectSizesTest, FrictionIsAForce) {
  const Sized beside({"coulomb_friction", "sign, beside the body", {"omega"}, {}, {-0.4}});
  EXPECT_EQ(beside.value("friction_force"), 0.4);
  EXPECT_EQ(beside.named("friction_force").unit, "N");
  EXPECT_THAT(beside.named("friction_force").meaning, testing::HasSubstr("against"));
  EXPECT_NEAR(beside.named("friction_force").std_error, beside.named("coefficient").std_error,
              1e-9 * beside.named("coefficient").std_error);
  // Behind the body at 0 Hz, where all differences are 0: c_0 / A(1).
  const Sized through(
      {"coulomb_friction", "sign, through the body", {"omega"}, {}, {-0.1, 0.05, 0.0}});
  EXPECT_NEAR(through.value("friction_force"), 0.1 / at_rest(kDenominator), 1e-12);
}

TEST(EffectSizesTest, HysteresisOfAChannelHasYieldForceAndSlipDistance) {
  const Sized sut(made::effect_of("hysteresis", "elastic-plastic, beside the body", {"theta"},
                                  {{"threshold", "rad", 0.4, 1e-3, 5.0}}, {0.3, -0.1}));
  EXPECT_EQ(sut.value("yield_force"), 0.3);
  EXPECT_EQ(sut.value("slip_distance"), 0.4);
  EXPECT_EQ(sut.named("slip_distance").unit, "rad");
  EXPECT_DOUBLE_EQ(sut.value("sticking_stiffness"), 0.75);
  EXPECT_EQ(sut.named("sticking_stiffness").unit, "N/rad");
}

// E = q^-1 sum e_i D^i is e_0 at 0 Hz.
TEST(EffectSizesTest, ALoopOfTheOutputHasItsStaticForceAndStiffness) {
  const double a = at_rest(kDenominator);
  const Sized slips(made::effect_of("hysteresis", "elastic-plastic of the output", {},
                                    {{"threshold", "N", 0.5, 0.01, 25.0}}, {-0.03, 0.02}));
  EXPECT_NEAR(slips.value("yield_force"), 0.03 / a, 1e-12);
  EXPECT_EQ(slips.value("slip_force"), 0.5);
  EXPECT_FALSE(slips.named("slip_force").at_hz.has_value());
  EXPECT_NEAR(slips.value("stiffness_ratio"), a / (a + 0.03 / 0.5), 1e-12);
  const Sized gap(made::effect_of("dead_zone", "play of the output", {},
                                  {{"threshold", "N", 0.4, 0.01, 20.0}}, {0.03, -0.01}));
  EXPECT_EQ(gap.value("gap_width"), 0.8);
  EXPECT_NEAR(gap.value("stiffness_ratio"), (a - 0.03 / 0.4) / a, 1e-12);
  const Sized sides(
      {"asymmetry", "slopes of the output", {}, {constant("threshold", "N", 1.0)}, {0.01, -0.005}});
  EXPECT_NEAR(sides.value("stiffness_ratio"), (a - 0.01) / (a + 0.01), 1e-12);
  // z^2 has the slopes 2 z and -2 z at the largest z that was seen; M = E over the threshold.
  const Sized square(made::effect_of("asymmetry", "square of the output", {},
                                     {constant("threshold", "N", 2.0)}, {1e-3, 0.0}));
  const double z = largest_deflection(square.line.run.body, 0.0, square.signals) / 2.0;
  EXPECT_NEAR(square.value("stiffness_ratio"), (a - 1e-3 * z) / (a + 1e-3 * z), 1e-12);
}

// The slope of phi by central differences at the largest output that was seen: h^2/6 of its third
// derivative, rounding of 1e-16 over h.
TEST(EffectSizesTest, ASpringHardensOrSoftensAtTheLargestForceSeen) {
  constexpr double kStep = 1e-5;
  for (const char* form : {"cubic of the output", "bent of the output", "levelled of the output"}) {
    const Effect effect{
        "nonlinear_stiffness", form, {}, {constant("threshold", "N", 0.8)}, {-1e-3, 0.0}};
    const Sized sut(effect);
    const double z = largest_deflection(sut.line.run.body, 0.0, sut.signals) / 0.8;
    const Nonlinearity law = effect_kind(effect.kind).feedback(effect);
    LoopMemory none;
    const double slope = (law.phi(z + kStep, none) - law.phi(z - kStep, none)) / (2.0 * kStep);
    const double a = at_rest(kDenominator);
    EXPECT_NEAR(sut.value("stiffness_ratio"), (a + 1e-3 / 0.8 * slope) / a, 1e-9) << form;
  }
}

// The numbers of every_effect.hpp; x is the largest deflection from the centre of 0.05 rad.
TEST(EffectSizesTest, EachNumberIsItsClosedForm) {
  // Of three samples the first weighs nothing.
  const Signals few = made::signals_of({1.0, 2.0, 4.0}, {0.0, 1.0, 0.0}).weighed({0.0, 1.0, 1.0});
  EXPECT_EQ(largest_deflection({9.0, 1.0, -3.0}, 1.0, few), 4.0);
  const Signals signals(made::every_channel(kSamples, 11), {"u"}, "y");
  const double a = at_rest(kDenominator);
  const double x = largest_deflection(signals.at("theta").values, 0.05, signals);
  const double y = largest_deflection(signals.output().values, 0.0, signals);
  const double both = signals.at("a_x").deviation * signals.at("theta").deviation;
  struct Row {
    const char* kind;
    const char* form;
    const char* size;
    double want;
  };
  const auto all = made::every_effect();
  for (const Row& row :
       {Row{"bilinear", "beside the body", "force", 0.3 * both},
        {"bilinear", "through the body", "force", 0.1 / a * both},
        {"asymmetry", "square, beside the body", "even_force", 0.3 * x * x},
        {"asymmetry", "square, through the body", "even_force", 0.1 / a * x * x},
        {"nonlinear_stiffness", "cubic, beside the body", "stiffness_at_largest",
         0.1 + 3.0 * 0.3 * x * x},
        {"nonlinear_stiffness", "cubic, beside the body", "cubic_force", 0.3 * x * x * x},
        {"nonlinear_stiffness", "at the output", "stiffness_ratio", 1.0 + 0.15 * y * y},
        {"nonlinear_stiffness", "at the output", "cubic_force", 0.05 * y * y * y},
        {"position_ripple", "two harmonics", "amplitude", std::hypot(0.1, 0.2)},
        {"position_ripple", "two harmonics", "amplitude_2", std::hypot(0.1, 0.05)},
        {"position_ripple", "two harmonics", "period", 0.4},
        {"tone", "beside the body", "amplitude", std::hypot(0.1, 0.2)},
        // (c_1 D + c_2)/M = (c_1 + c_2 - c_1 q^-1)/M at the mode's own frequency.
        {"resonance", "beside the body", "magnitude",
         std::abs(made::response({{{0.07, -0.05}}, made::mode(9.0, 0.1)}, 9.0))},
        {"drift", "linear", "change", 0.3},
        {"drift", "exponential", "change", 0.3 * (1.0 - std::exp(-19.99 / 5.0))},
        {"time_varying_gain", "linear", "lowest_gain", 0.8},
        {"time_varying_gain", "linear", "highest_gain", 1.2},
        {"free_form", "force over a channel", "range", 0.5},
        {"free_form", "gain over a channel", "range", 0.6},
        // From first to last knot the curve rises by 1.8 over 2.9; its third knot, 1.8 on, lies 1.5
        // above the first.  E(1) = 0.02.
        {"free_form", "curve inside the body", "range", (1.5 - 1.8 * 1.8 / 2.9) * 0.02 / a}}) {
    const auto effect = std::ranges::find_if(
        all, [&](const Effect& each) { return each.kind == row.kind && each.form == row.form; });
    ASSERT_NE(effect, all.end()) << row.kind << ", " << row.form;
    EXPECT_NEAR(Sized(*effect).value(row.size), row.want, 1e-9 * std::abs(row.want))
        << row.kind << ", " << row.form << ", " << row.size;
  }
}

// Inside the body another scale of N, with its inverse in M and E, is the same spring.
TEST(EffectSizesTest, TheScaleInsideTheBodyDoesNotMatter) {
  const std::vector<double> path{0.02, -0.01, 0.005, 0.04, 0.01, 0.0, -0.001, 0.002};
  std::vector<double> scaled = path;
  for (std::size_t i = 0; i < 3; ++i) scaled[i] /= 8.0;        // E / 2^3
  for (std::size_t i = 3; i < 6; ++i) scaled[i] *= 2.0;        // N
  for (std::size_t i = 6; i < 8; ++i) scaled[i] *= 2.0 / 8.0;  // M
  const Sized one({"nonlinear_stiffness", "cubic inside the body", {}, {}, path});
  const Sized other({"nonlinear_stiffness", "cubic inside the body", {}, {}, scaled});
  EXPECT_NEAR(one.value("stiffness_ratio"), other.value("stiffness_ratio"), 1e-9);
  EXPECT_NEAR(one.named("stiffness_ratio").std_error, other.named("stiffness_ratio").std_error,
              1e-3 * one.named("stiffness_ratio").std_error);
  EXPECT_GT(one.named("stiffness_ratio").std_error, 0.0);
}

// Eq. DG-73 to DG-75 with the slope 1 at rest: |(B + E Z)/A|/|Z|, Z = N/(A - M).
TEST(EffectSizesTest, AForceInsideTheBodyIsThatOfSmallMotions) {
  const Sized sut(made::effect_of("hysteresis", "elastic-plastic inside the body", {}, {},
                                  {0.02, -0.01, 0.005, 0.4, 0.1, 0.0, -0.01, 0.002}));
  const LoopPath path = loop_path(sut.at.effect(), 2);
  EXPECT_GT(sut.named("slip_force").at_hz.value(), 0.5);
  EXPECT_LT(sut.named("slip_force").at_hz.value(), 8.0);
  const auto at = [&](const std::vector<double>& c) {
    return made::response({{c}, {1.0}}, sut.named("slip_force").at_hz.value());
  };
  const auto z = at(path.n) / (at(kDenominator) - at(path.m));
  const auto y = (at(sut.model.body.numerators[0]) + at(path.e) * z) / at(kDenominator);
  EXPECT_NEAR(sut.value("slip_force"), std::abs(y / z), 1e-9);
  const double a = at_rest(kDenominator);
  EXPECT_NEAR(sut.value("yield_force"), 0.02 / a, 1e-9);
  EXPECT_NEAR(sut.value("stiffness_ratio"), a / (a + 0.01), 1e-9);
  // With the slope 0 at rest B/A over N/A; the slope is that of a step of 1e-4: 3e-9.
  const Sized level(made::effect_of("nonlinear_stiffness", "levelled inside the body", {}, {},
                                    {0.02, -0.01, 0.005, 0.4, 0.1, 0.0, -0.01, 0.002}));
  EXPECT_NEAR(level.value("threshold_force"),
              std::abs(at(level.model.body.numerators[0]) / at(path.n)), 1e-8);
  // z = -y: where the output is positive, |z| has the slope -1.
  const Sized against(made::effect_of("asymmetry", "slopes inside the body", {}, {},
                                      {0.0, 0.0, 0.0, -0.1, -0.2, -0.2, 0.01, 0.0}));
  EXPECT_NEAR(against.value("stiffness_ratio"), (a + 0.01) / (a - 0.01), 1e-9);
}

// (1 - k) / (1 - k z^-1) against 1 / (1 + 2 pi j f lag): a sample of 10 ms by 150 ms.
TEST(EffectSizesTest, APathHasItsMagnitudeAtAStatedFrequency) {
  const Sized sut({"coupled_input", "lagged", {"a_x"}, {{"lag", "s", 0.15, 0.005, 2.0}}, {0.5}});
  EXPECT_DOUBLE_EQ(sut.value("gain"), 0.5);
  const Size& magnitude = sut.named("magnitude");
  ASSERT_TRUE(magnitude.at_hz.has_value());
  const double turn = 2.0 * std::numbers::pi * *magnitude.at_hz * 0.15;
  EXPECT_NEAR(magnitude.value, 0.5 / std::hypot(1.0, turn), 0.01);
  EXPECT_EQ(magnitude.unit, "N/(m/s^2)");
  const Sized angle({"coupled_input", "static with rate", {"theta", "omega"}, {}, {0.2, 0.1}});
  EXPECT_NEAR(angle.value("gain_per_degree"), 0.2 * std::numbers::pi / 180.0, 1e-15);
  EXPECT_EQ(angle.named("gain_per_degree").unit, "N/deg");
  const double hz = *angle.named("magnitude").at_hz;
  EXPECT_NEAR(angle.value("magnitude"), std::hypot(0.2, 0.1 * 2.0 * std::numbers::pi * hz), 1e-12);
}

TEST(EffectSizesTest, AResponseHasErrorsOfMagnitudeAndPhase) {
  const Sized sut({"coupled_input", "lagged", {"a_x"}, {{"lag", "s", 0.15, 0.005, 2.0}}, {0.5}});
  const NumberErrors errors(sut.model, sut.line, sut.signals);
  const auto points = path_response(sut.at, errors, {0.01, 1.0, 5.0});
  ASSERT_EQ(points.size(), 3u);
  // At rest the gain alone counts.
  EXPECT_NEAR(points[0].magnitude_error, sut.named("coefficient").std_error,
              0.01 * sut.named("coefficient").std_error);
  EXPECT_LT(points[0].phase_error_rad, points[1].phase_error_rad);
  const Sized friction({"coulomb_friction", "sign, beside the body", {"omega"}, {}, {-0.4}});
  EXPECT_TRUE(path_response(friction.at, errors, {1.0}).empty());
}

TEST(EffectSizesTest, MapsAndGainsHaveTheirNumbers) {
  EXPECT_DOUBLE_EQ(
      Sized({"dead_zone", "at the output", {}, {{"half_width", "N", 0.1, 0.0, 3.0}}, {}})
          .value("gap_width"),
      0.2);
  EXPECT_DOUBLE_EQ(
      Sized({"asymmetry", "slopes at the output", {}, {{"slope_change", "-", 0.25, -0.9, 0.9}}, {}})
          .value("slope_ratio"),
      1.25 / 0.75);
  const Sized limited(
      {"input_saturation", "hard", {"u"}, {{"limit", "m/s^2", 0.9, 0.02, 9.0}}, {}});
  EXPECT_NEAR(limited.value("limit_force"), 0.9 * 0.1 / at_rest(kDenominator), 1e-12);
  const Sized change(
      made::effect_of("regime_change", "step of the gain", {},
                      {{"time", "s", 4.0, 0.0, 60.0, false}, {"change", "-", 0.25, -5.0, 5.0}}));
  EXPECT_DOUBLE_EQ(change.value("gain_ratio"), 1.25 / 0.75);
  EXPECT_TRUE(std::isnan(change.named("time").std_error)) << "it was searched, not fitted";
}

TEST(EffectSizesTest, ARatioOfUnitsIsWrittenAsAHeaderHasIt) {
  EXPECT_EQ(unit_over("N", "m/s^2"), "N/(m/s^2)");
  EXPECT_EQ(unit_over("N", "-"), "N");
  EXPECT_EQ(unit_over("N", "N"), "-");
  EXPECT_EQ(unit_over("-", "s"), "1/s");
}

}  // namespace stillhand::diagnosis::effect_sizes_test
