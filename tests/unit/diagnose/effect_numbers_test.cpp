// SPDX-License-Identifier: Apache-2.0
// Numbers of a model with units and standard errors, from recordings that the model made itself.
#include "apps/diagnose/page/effect_numbers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/core/diagnosis/model/modes.hpp"
#include "tests/unit/diagnose/sample_recordings.hpp"

namespace stillhand::diagnose::effect_numbers_test {

using diagnosis::Body;
using diagnosis::constant;
using diagnosis::Effect;
using testing::ElementsAre;

constexpr double kNoise_n = 0.1;

Body one_mode() {
  Body body;
  body.denominator = diagnosis::mode_denominator(3.0, 0.3, test::kRate_hz);
  body.numerators = {{0.5, -0.6, 0.2}};
  body.offset = 0.25;
  return body;
}

Body static_body() { return {.numerators = {{-3.2}}}; }

// Keeps the diagnosis that the evidence refers to.
struct Made {
  Made(const Body& body, const Effect& effect)
      : made(test::made_with(body, effect, kNoise_n)), evidence(made.found, made.measurement) {}
  test::MadeDiagnosis made;
  Evidence evidence;
};

std::vector<std::string> names_of(const std::vector<ModelNumber>& numbers) {
  std::vector<std::string> names;
  for (const ModelNumber& each : numbers) names.push_back(each.name);
  return names;
}

const Effect kFriction{"coulomb_friction", "sign, beside the body", {"omega"}, {}, {-1.0}};

// A zero hides the pole: its error is larger than itself.  A real pole has no damping of its own.
TEST(EffectNumbersTest, AHiddenPoleIsNotDetermined) {
  Body body;
  body.denominator = {1.0, -0.9};
  body.numerators = {{-3.2, 2.88}};
  const Made of(body, kFriction);
  const auto sut = body_numbers(of.evidence);
  EXPECT_EQ(sut.back().name, "pole 1 (real): natural frequency");
  EXPECT_TRUE(std::isnan(sut.back().standard_error)) << sut.back().standard_error;
}

TEST(EffectNumbersTest, ThePhysicalNumberComesFirstAndThenWhatWasFitted) {
  const Made of(static_body(), kFriction);
  const auto sut = effect_numbers(of.evidence, 0);
  ASSERT_EQ(sut.size(), 2u);
  EXPECT_EQ(sut[0].name, "friction force, against the sign of omega");
  EXPECT_EQ(sut[0].value, 1.0);
  EXPECT_EQ(sut[0].origin, "derived");
  EXPECT_EQ(sut[1].name, "coefficient");
  EXPECT_EQ(sut[1].value, -1.0);
  EXPECT_EQ(sut[1].unit, "N");
  EXPECT_EQ(sut[1].origin, "fitted");
}

// 5900 samples that count (without the first second) and a sign of size 1: noise/sqrt(5900), more
// by what the sign has in common with offset and input, and by the noise model's own error: up to
// 10 % each way.
TEST(EffectNumbersTest, AStandardErrorIsThatOfItsOwnNumber) {
  const Made of(static_body(), kFriction);
  for (const ModelNumber& number : effect_numbers(of.evidence, 0)) {
    EXPECT_NEAR(number.standard_error, kNoise_n / std::sqrt(5900.0),
                0.15 * kNoise_n / std::sqrt(5900.0))
        << number.name;
  }
}

TEST(EffectNumbersTest, SeveralCoefficientsAreCountedAndHaveTheirUnits) {
  const Made of(one_mode(), {"nonlinear_stiffness",
                             "cubic, beside the body",
                             {"omega"},
                             {constant("centre", "rad/s", 0.1)},
                             {0.5, 0.2}});
  const auto all = effect_numbers(of.evidence, 0);
  ASSERT_EQ(all.size(), 6u);
  const std::vector<ModelNumber> sut(all.begin() + 3, all.end());
  ASSERT_THAT(names_of(sut), ElementsAre("coefficient 1", "coefficient 2", "centre"));
  EXPECT_EQ(sut[0].unit, "N/(rad/s)");
  EXPECT_EQ(sut[1].unit, "N/((rad/s)³)");
  EXPECT_EQ(sut[2].origin, "given");
  EXPECT_TRUE(std::isnan(sut[2].standard_error)) << "a number that is given has no error";
}

TEST(EffectNumbersTest, APathThroughTheBodyHasAResponseAndNoSingleCoefficient) {
  const Made of(one_mode(), {"coupled_input", "through the body", {"omega"}, {}, {0.1, 0.2, 0.3}});
  const auto sut = effect_numbers(of.evidence, 0);
  for (const ModelNumber& number : sut) {
    EXPECT_THAT(number.name, testing::Not(testing::HasSubstr("coefficient")));
    EXPECT_GT(number.standard_error, 0.0) << number.name;
  }
  EXPECT_THAT(names_of(sut), testing::Contains(testing::MatchesRegex("magnitude at .* Hz, .*")));
}

TEST(EffectNumbersTest, AParameterStatesWhereItsValueIsFrom) {
  const Made of(one_mode(),
                {"regime_change",
                 "step of the gain",
                 {},
                 {{"time", "s", 30.0, 0.0, 60.0, false}, {"change", "-", 0.25, -5.0, 5.0}},
                 {}});
  const auto sut = effect_numbers(of.evidence, 0);
  ASSERT_EQ(sut.size(), 3u);
  EXPECT_EQ(sut[1].name, "time");
  EXPECT_EQ(sut[1].origin, "searched");
  EXPECT_TRUE(std::isnan(sut[1].standard_error));
  EXPECT_EQ(sut[2].name, "change");
  EXPECT_EQ(sut[2].origin, "fitted");
  EXPECT_GT(sut[2].standard_error, 0.0);
}

// Poles and back: a quadratic's roots, a few roundings.
TEST(EffectNumbersTest, ABodysPolesAreItsModes) {
  const Made of(one_mode(), kFriction);
  const auto sut = body_numbers(of.evidence);
  ASSERT_EQ(sut.size(), 4u);
  EXPECT_EQ(sut[0].name, "offset");
  EXPECT_EQ(sut[0].value, 0.25);
  EXPECT_GT(sut[0].standard_error, 0.0);
  const auto& a = one_mode().denominator;
  EXPECT_NEAR(sut[1].value, 0.1 / (a[0] + a[1] + a[2]), 1e-12);
  EXPECT_EQ(sut[1].unit, "N/(m/s²)");
  EXPECT_NEAR(sut[2].value, 3.0, 1e-9);
  EXPECT_EQ(sut[2].unit, "Hz");
  EXPECT_NE(sut[2].name.find("pair"), std::string::npos);
  for (const ModelNumber& number : sut) EXPECT_GT(number.standard_error, 0.0) << number.name;
  EXPECT_NEAR(sut[3].value, 0.3, 1e-9);
}

// 0.9 and 0.5: natural frequency -ln(z) 100/(2 pi), and no damping ratio.
TEST(EffectNumbersTest, ARealPoleIsOnePole) {
  Body body;
  body.denominator = {1.0, -1.4, 0.45};
  body.numerators = {{0.1, 0.0, 0.0}};
  const Made of(body, kFriction);
  const auto sut = body_numbers(of.evidence);
  ASSERT_EQ(sut.size(), 4u);
  std::vector<double> frequencies_hz{sut[2].value, sut[3].value};
  std::ranges::sort(frequencies_hz);
  EXPECT_NEAR(frequencies_hz[0], -std::log(0.9) * 100.0 / (2.0 * std::numbers::pi), 1e-9);
  EXPECT_NEAR(frequencies_hz[1], -std::log(0.5) * 100.0 / (2.0 * std::numbers::pi), 1e-9);
  for (const std::size_t i : {2u, 3u}) {
    EXPECT_NE(sut[i].name.find("(real): natural frequency"), std::string::npos) << sut[i].name;
  }
}

TEST(EffectNumbersTest, AStaticBodyIsAFactorWithItsError) {
  const Made of(static_body(), kFriction);
  const auto sut = body_numbers(of.evidence);
  ASSERT_EQ(sut.size(), 2u);
  EXPECT_EQ(sut[1].name, "factor of a_y");
  EXPECT_EQ(sut[1].value, -3.2);
  EXPECT_GT(sut[1].standard_error, 0.0);
}

}  // namespace stillhand::diagnose::effect_numbers_test
