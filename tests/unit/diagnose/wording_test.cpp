// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/page/wording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace stillhand::diagnose::wording_test {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(WordingTest, AUnitIsWrittenAsPeopleDo) {
  EXPECT_EQ(shown_unit("m/s^2"), "m/s²");
  EXPECT_EQ(shown_unit("(m/s^2)^3"), "(m/s²)³");
  EXPECT_EQ(shown_unit("N*m"), "N·m");
  EXPECT_EQ(shown_unit("degC"), "°C");
  EXPECT_EQ(shown_unit("deg"), "°");
  EXPECT_EQ(shown_unit("deg/s"), "°/s");
  EXPECT_EQ(shown_unit("us"), "µs");
  EXPECT_EQ(shown_unit("us/s"), "µs/s");
  EXPECT_EQ(shown_unit(""), "");
}

TEST(WordingTest, AUnitThatOnlyBeginsLikeAnotherStays) {
  EXPECT_EQ(shown_unit("degree_day"), "degree_day");
  EXPECT_EQ(shown_unit("users"), "users");
}

TEST(WordingTest, ANumberHasItsUnitUnlessItIsAPureNumber) {
  EXPECT_EQ(shown(1.5, "m/s^2"), "1.5 m/s²");
  EXPECT_EQ(shown(1.5, "-"), "1.5");
  EXPECT_EQ(shown(1.5, "1"), "1.5");
  EXPECT_EQ(shown(1.5, ""), "1.5");
  EXPECT_EQ(axis_label("a_y", "m/s^2"), "a_y [m/s²]");
  EXPECT_EQ(axis_label("count", ""), "count");
}

TEST(WordingTest, ARatioOfUnitsPutsACompoundInBrackets) {
  EXPECT_EQ(unit_ratio("N", "m"), "N/m");
  EXPECT_EQ(unit_ratio("N", "m/s^2"), "N/(m/s²)");
  EXPECT_EQ(unit_ratio("N", "m*s"), "N/(m·s)");
  EXPECT_EQ(unit_ratio("m/s^2", "m/s^2"), "-") << "one of them cancels the other";
  EXPECT_EQ(unit_ratio("-", "rad"), "1/rad");
  EXPECT_EQ(unit_ratio("N", "-"), "N");
  EXPECT_EQ(unit_ratio("", "1"), "-");
}

TEST(WordingTest, ASentenceGetsTheOutputsUnit) {
  EXPECT_EQ(shown_sentence("a force of 3 (output unit) and -2 us more", "m/s^2"),
            "a force of 3 m/s² and −2 µs more");
  EXPECT_THAT(shown_sentence("a gain of 2 (output unit per channel unit)", "N"),
              AllOf(HasSubstr("2 N"), Not(HasSubstr("output unit"))));
  EXPECT_EQ(shown_sentence("within +-0.5 m, +-1 m", "N"), "within ±0.5 m, ±1 m");
  EXPECT_EQ(shown_sentence("", "N"), "");
}

// What is put in must not be looked at again: a unit may hold what is searched for.
TEST(WordingTest, AUnitThatHoldsThePlaceholderEnds) {
  EXPECT_THAT(shown_sentence("3 (output unit)", "x(output unit)"), HasSubstr("x(output unit)"));
}

TEST(WordingTest, AnEffectIsTitledWithItsChannel) {
  diagnosis::FoundEffect effect;
  effect.effect.kind = "coulomb_friction";
  EXPECT_EQ(effect_title(effect), "coulomb friction");
  effect.channel = "omega";
  EXPECT_EQ(effect_title(effect), "coulomb friction (omega)");
  EXPECT_EQ(spaced("time_varying_gain"), "time varying gain");
}

TEST(WordingTest, AProbabilityTooSmallForADoubleIsAnUpperBound) {
  EXPECT_EQ(p_value(0.0), "< 10⁻³⁰⁰");
  EXPECT_EQ(p_value(0.5), "0.5");
  EXPECT_THAT(p_value(1e-200), HasSubstr("10⁻²⁰⁰"));
}

TEST(WordingTest, AShareIsAPercentage) {
  EXPECT_EQ(percent(0.1234, 1), "12.3 %");
  EXPECT_EQ(percent(0.1234, 0), "12 %");
  EXPECT_EQ(percent(-0.5, 0), "−50 %");
  EXPECT_THAT(percent(std::nan(""), 1), HasSubstr("–"));
}

diagnosis::Diagnosis of_order(std::size_t order) {
  diagnosis::Diagnosis diagnosis;
  diagnosis.output_unit = "N";
  diagnosis.baseline.model.body.denominator.assign(order + 1, 0.0);
  diagnosis.baseline_error = {2.0, 1.9, 2.1, 80.0};
  diagnosis.final_error = {1.0, 0.9, 1.1, 95.0};
  diagnosis.carried_error = {1.25, 1.2, 1.3, 92.0};
  diagnosis.noise_floor.rmse = 0.75;
  diagnosis.noise_floor.low = 0.7;
  diagnosis.noise_floor.high = 0.8;
  return diagnosis;
}

diagnosis::FoundEffect found(const char* kind, const char* channel = "") {
  diagnosis::FoundEffect effect;
  effect.effect.kind = kind;
  effect.channel = channel;
  return effect;
}

// The headline is the saved model's error; what all effects leave on this record stands behind it.
TEST(WordingTest, AVerdictNamesEffectsAndErrors) {
  diagnosis::Diagnosis diagnosis = of_order(4);
  diagnosis.effects = {found("coulomb_friction", "omega"), found("tone"), found("drift")};
  diagnosis.effects[0].carried = 1.0;
  const std::string sut = verdict_in_words(diagnosis);
  EXPECT_THAT(sut,
              AllOf(HasSubstr("order 4"), HasSubstr("coulomb friction (omega), tone and drift"),
                    HasSubstr("1.25 N (95 %: 1.2 to 1.3) instead of 2 N; with all of them, 1 N."),
                    HasSubstr("0.75 N (0.7 to 0.8)")));
  EXPECT_THAT(sut, Not(HasSubstr("none of")));
  EXPECT_THAT(sut, Not(HasSubstr("ties")));
  EXPECT_TRUE(sut.ends_with("."));
}

TEST(WordingTest, AVerdictOfWhichNothingIsCarriedSaysSoInTheSameSentence) {
  diagnosis::Diagnosis diagnosis = of_order(4);
  diagnosis.effects = {found("tone")};
  EXPECT_THAT(verdict_in_words(diagnosis),
              HasSubstr("instead of 2 N; none of it is saved for other recordings."));
  diagnosis.effects[0].carried = 1.0;
  EXPECT_THAT(verdict_in_words(diagnosis), Not(HasSubstr("saved")));
}

TEST(WordingTest, AnEffectSaysHowMuchOfItIsCarried) {
  diagnosis::FoundEffect effect = found("tone");
  effect.why_not_carried = "the inputs do not determine it";
  EXPECT_EQ(carried_in_words(effect), "not saved: the inputs do not determine it");
  effect.carried = 0.67;
  effect.why_not_carried = "so much is borne out";
  EXPECT_EQ(carried_in_words(effect), "saved to 67 %: so much is borne out");
  effect.carried = 1.0;
  EXPECT_EQ(carried_in_words(effect),
            "saved: it needs the inputs alone, so it can predict another recording");
}

TEST(WordingTest, AVerdictMentionsTiesAndWhatIsLeft) {
  diagnosis::Diagnosis diagnosis = of_order(0);
  diagnosis.effects = {found("tone"), found("drift")};
  const std::string before = verdict_in_words(diagnosis);
  EXPECT_THAT(before, AllOf(HasSubstr("static"), HasSubstr("tone and drift")));
  diagnosis.effects[1].ties = {"delay"};
  const std::string tied = verdict_in_words(diagnosis);
  EXPECT_THAT(tied, HasSubstr("ties"));
  diagnosis.unexplained = diagnosis::Unexplained{};
  EXPECT_NE(verdict_in_words(diagnosis), tied);
}

TEST(WordingTest, WhatIsTooSmallIsNamedAndIsNotWhatTheModelLacks) {
  diagnosis::Diagnosis diagnosis = of_order(4);
  diagnosis.effects = {found("tone"), found("drift")};
  EXPECT_EQ(too_small_in_words(diagnosis), "");
  diagnosis.effects[0].carried = 1.0;
  diagnosis.effects[1].counts = false;
  diagnosis.effects[1].explained.rms = 0.04;
  const std::string one = verdict_in_words(diagnosis);
  EXPECT_THAT(one, AllOf(HasSubstr("lacks tone."), HasSubstr("too small to count: drift of 0.04 N"),
                         HasSubstr("less than 0.1 N")));
  diagnosis.effects[0].counts = false;
  const std::string none = verdict_in_words(diagnosis);
  EXPECT_THAT(none, AllOf(HasSubstr("Nothing missing that counts"), HasSubstr("tone of"),
                          HasSubstr("1 N"), Not(HasSubstr("lacks"))));
}

TEST(WordingTest, WithoutEffectsTheVerdictGivesTheBaselinesError) {
  diagnosis::Diagnosis diagnosis = of_order(2);
  const std::string nothing = verdict_in_words(diagnosis);
  EXPECT_THAT(nothing, AllOf(HasSubstr("order 2"), HasSubstr("2 N"), HasSubstr("1.9 to 2.1")));
  diagnosis.unexplained = diagnosis::Unexplained{};
  const std::string unexplained = verdict_in_words(diagnosis);
  EXPECT_THAT(unexplained, AllOf(HasSubstr("2 N"), HasSubstr("0.75 N")));
  EXPECT_NE(nothing, unexplained);
}

}  // namespace stillhand::diagnose::wording_test
