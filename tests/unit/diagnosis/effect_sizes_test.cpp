// SPDX-License-Identifier: Apache-2.0
// Physical numbers by their closed forms.
#include "services/core/diagnosis/effect_sizes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

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
  const Sized sut({"hysteresis",
                   "elastic-plastic, beside the body",
                   {"theta"},
                   {{"threshold", "rad", 0.4, 1e-3, 5.0}},
                   {0.3, -0.1}});
  EXPECT_EQ(sut.value("yield_force"), 0.3);
  EXPECT_EQ(sut.value("slip_distance"), 0.4);
  EXPECT_EQ(sut.named("slip_distance").unit, "rad");
  EXPECT_DOUBLE_EQ(sut.value("sticking_stiffness"), 0.75);
  EXPECT_EQ(sut.named("sticking_stiffness").unit, "N/rad");
}

// E = q^-1 sum e_i D^i is e_0 at 0 Hz.
TEST(EffectSizesTest, ALoopOfTheOutputHasItsStaticForceAndStiffness) {
  const double a = at_rest(kDenominator);
  const Sized slips({"hysteresis",
                     "elastic-plastic of the output",
                     {},
                     {{"threshold", "N", 0.5, 0.01, 25.0}},
                     {-0.03, 0.02}});
  EXPECT_NEAR(slips.value("yield_force"), 0.03 / a, 1e-12);
  EXPECT_EQ(slips.value("slip_force"), 0.5);
  EXPECT_FALSE(slips.named("slip_force").at_hz.has_value());
  EXPECT_NEAR(slips.value("stiffness_ratio"), a / (a + 0.03 / 0.5), 1e-12);
  const Sized gap({"dead_zone",
                   "play of the output",
                   {},
                   {{"threshold", "N", 0.4, 0.01, 20.0}},
                   {0.03, -0.01}});
  EXPECT_EQ(gap.value("gap_width"), 0.8);
  EXPECT_NEAR(gap.value("stiffness_ratio"), (a - 0.03 / 0.4) / a, 1e-12);
  const Sized sides(
      {"asymmetry", "slopes of the output", {}, {constant("threshold", "N", 1.0)}, {0.01, -0.005}});
  EXPECT_NEAR(sides.value("stiffness_ratio"), (a - 0.01) / (a + 0.01), 1e-12);
}

// phi' = 3 z^2 at the largest output that was seen.
TEST(EffectSizesTest, ASpringHardensOrSoftensAtTheLargestForceSeen) {
  const Sized sut({"nonlinear_stiffness",
                   "cubic of the output",
                   {},
                   {constant("threshold", "N", 1.0)},
                   {-1e-3, 0.0}});
  const double largest = largest_deflection(sut.line.run.body, 0.0, sut.signals);
  const double a = at_rest(kDenominator);
  EXPECT_NEAR(sut.value("stiffness_ratio"), (a + 1e-3 * 3.0 * largest * largest) / a, 1e-12);
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

// With the slope at rest 0 the output is B/A and z is N/A times the input: B/N at the frequency.
TEST(EffectSizesTest, AThresholdInsideTheBodyIsAnAmplitudeOfTheOutput) {
  const Sized sut({"nonlinear_stiffness",
                   "levelled inside the body",
                   {},
                   {},
                   {0.02, -0.01, 0.005, 0.4, 0.1, 0.0, -0.01, 0.002}});
  const Size& threshold = sut.named("threshold_force");
  ASSERT_TRUE(threshold.at_hz.has_value());
  EXPECT_GT(*threshold.at_hz, 0.5);
  EXPECT_LT(*threshold.at_hz, 8.0);
  const Body like{{sut.model.body.numerators[0]}, difference_basis({0.4, 0.1, 0.0}), 0.0};
  // The slope at rest is that of a step of 1e-4: 3e-9.
  EXPECT_NEAR(threshold.value, std::abs(made::response(like, *threshold.at_hz)), 1e-8);
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
  const Sized change({"regime_change",
                      "step of the gain",
                      {},
                      {{"time", "s", 4.0, 0.0, 60.0, false}, {"change", "-", 0.25, -5.0, 5.0}},
                      {}});
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
