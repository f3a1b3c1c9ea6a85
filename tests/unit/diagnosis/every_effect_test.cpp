// SPDX-License-Identifier: Apache-2.0
// Invariants that every kind and form of effect keeps, each run next to the same body.
#include "tests/unit/diagnosis/every_effect.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/model/examples.hpp"

namespace stillhand::diagnosis::every_effect_test {

// Odd, as elsewhere: what is written one sample too far is not hidden by the padding of even
// blocks.
constexpr std::size_t kCount = 801;

std::string name_of(const Effect& effect) { return effect.kind + ", " + effect.form; }

Signals signals_of(const Measurement& measurement) { return {measurement, {"u"}, "y"}; }

std::vector<double> prediction_of(const std::vector<Effect>& effects, const Signals& signals) {
  const FreeRun run = free_run(made::model_of(made::two_pole_body(), effects), signals);
  EXPECT_TRUE(run.finite);
  return run.prediction;
}

TEST(EveryEffectTest, NoKindIsMissingFromTheList) {
  std::set<std::string> listed;
  for (const Effect& sut : made::every_effect()) listed.insert(sut.kind);
  for (const EffectKind* kind : effect_kinds()) {
    EXPECT_TRUE(listed.contains(std::string(kind->name())))
        << kind->name()
        << ": derive it from MakesExamples, or add its forms to a list in every_effect.hpp";
  }
}

TEST(EveryEffectTest, EachChangesThePredictionOrTheWeight) {
  const Signals signals = signals_of(made::every_channel(kCount, 11));
  const FreeRun linear = free_run(made::model_of(made::two_pole_body()), signals);
  for (const Effect& sut : made::every_effect()) {
    const FreeRun run = free_run(made::model_of(made::two_pole_body(), {sut}), signals);
    EXPECT_TRUE(run.finite) << name_of(sut);
    const bool weighs = effect_kind(sut.kind).stage(sut) == Stage::kWeight;
    EXPECT_EQ(run.prediction != linear.prediction, !weighs) << name_of(sut);
    EXPECT_EQ(run.weight != linear.weight, weighs) << name_of(sut);
  }
}

// Zero times a finite column adds a zero: bit for bit.  A loop runs by another recursion than the
// plain body: 800 roundings of 1e-16, amplified by poles of radius 0.95 at most 20 times.
TEST(EveryEffectTest, WithoutItsCoefficientsALinearTermTakesNothing) {
  const Signals signals = signals_of(made::every_channel(kCount, 12));
  const auto linear = prediction_of({}, signals);
  for (Effect sut : made::every_effect()) {
    const Stage stage = effect_kind(sut.kind).stage(sut);
    if (stage != Stage::kTerm && stage != Stage::kFeedback) continue;
    if (sut.coefficients.empty()) continue;  // a stop
    std::ranges::fill(sut.coefficients, 0.0);
    const auto without = prediction_of({sut}, signals);
    const double allowed = stage == Stage::kTerm ? 0.0 : 1e-11;
    for (std::size_t n = 0; n < kCount; ++n) {
      ASSERT_NEAR(without[n], linear[n], allowed) << name_of(sut) << ", sample " << n;
    }
  }
}

// What came before a gap is unknown: the first stretch must not show in the second.
TEST(EveryEffectTest, NothingReachesOverAGap) {
  constexpr std::size_t kCut = 350;
  const Measurement one = made::cut_in_two(made::every_channel(kCount, 14), kCut, 7.0);
  Measurement other = one;
  for (std::size_t c = 0; c < other.channels.size(); ++c) {
    const auto more = made::white(kCut, 90 + c);
    for (std::size_t n = 0; n < kCut; ++n) other.channels[c].values[n] += 0.5 * more[n];
  }
  const Signals before = signals_of(one);
  const Signals after = signals_of(other);
  for (const Effect& sut : made::every_effect()) {
    const auto left = prediction_of({sut}, before);
    const auto right = prediction_of({sut}, after);
    EXPECT_TRUE(std::equal(left.begin() + kCut, left.end(), right.begin() + kCut)) << name_of(sut);
  }
}

// The model knows the past alone, but for two kinds: a delay is interpolated between six samples,
// three of them ahead, and the sign of a rate is its mean over half a sample on each side.
TEST(EveryEffectTest, TheFutureDoesNotShowInThePast) {
  constexpr std::size_t kFrom = 500;
  const Measurement one = made::every_channel(kCount, 15);
  Measurement other = one;
  for (std::size_t c = 0; c < other.channels.size(); ++c) {
    const auto more = made::white(kCount, 80 + c);
    for (std::size_t n = kFrom; n < kCount; ++n) other.channels[c].values[n] += 0.5 * more[n];
  }
  const Signals before = signals_of(one);
  const Signals after = signals_of(other);
  for (const Effect& sut : made::every_effect()) {
    const bool of_time = effect_kind(sut.kind).stage(sut) == Stage::kInputTime;
    const std::ptrdiff_t ahead = of_time ? 4 : (sut.kind == "coulomb_friction" ? 1 : 0);
    const auto left = prediction_of({sut}, before);
    const auto right = prediction_of({sut}, after);
    const auto until = static_cast<std::ptrdiff_t>(kFrom) - ahead;
    EXPECT_TRUE(std::equal(left.begin(), left.begin() + until, right.begin())) << name_of(sut);
  }
}

TEST(EveryEffectTest, WhatTheInputsDoNotDetermineIsExactlyWhatPredictionLeavesOut) {
  const Signals signals = signals_of(made::every_channel(kCount, 16));
  const auto linear = prediction_of({}, signals);
  for (const Effect& sut : made::every_effect()) {
    const Model model = made::model_of(made::two_pole_body(), {sut});
    const FreeRun determined = free_run(model, signals, false);
    const bool left_out = effect_kind(sut.kind).time_only(sut);
    EXPECT_EQ(determined.prediction, left_out ? linear : prediction_of({sut}, signals))
        << name_of(sut);
  }
}

// A position summed up from a rate begins anywhere, a measured one does not.
TEST(EveryEffectTest, ARippleOfADerivedPositionIsTimeAlone) {
  Effect sut{"position_ripple", "one harmonic", {"theta"}, {{"f", "1/rad", 2.0}}, {1.0, 0.0}};
  EXPECT_FALSE(effect_kind(sut.kind).time_only(sut));
  sut.channels = {"position of omega"};
  EXPECT_TRUE(effect_kind(sut.kind).time_only(sut));
}

// METHOD Eq. DG-62: a tenth of a gain or a stiffness, 20 ms between the clocks, the middle of the
// band and of the record.
TEST(EveryEffectTest, ExamplesHaveMiddlingNumbers) {
  const Signals signals = signals_of(made::every_channel(kCount, 11));
  const auto example = [&](const Body& body, const std::string& kind) {
    const auto all = examples(made::model_of(body), signals);
    return *std::ranges::find(all, kind, &Effect::kind);
  };
  const Body body = made::two_pole_body();
  const auto number = [&](const char* kind, std::size_t i) { return example(body, kind).value(i); };
  const double y = signals.output().deviation;
  const double middle_hz = std::sqrt(signals.lowest_excited_hz() * signals.highest_excited_hz());
  const double half_s = 0.5 * signals.duration_s();
  for (const char* kind : {"asymmetry", "time_varying_gain"}) EXPECT_EQ(number(kind, 0), 0.1);
  for (const char* kind : {"tone", "resonance"}) EXPECT_DOUBLE_EQ(number(kind, 0), middle_hz);
  EXPECT_EQ(number("resonance", 1), 0.035);
  const auto [low, high] = std::ranges::minmax(signals.at("theta").values);
  EXPECT_DOUBLE_EQ(number("position_ripple", 0) * (high - low), 7.0);
  EXPECT_THAT(example(body, "resonance").coefficients, testing::ElementsAre(0.0, 1.0));
  EXPECT_DOUBLE_EQ(1e-6 * number("clock_drift", 0) * signals.duration_s(), 0.02);
  EXPECT_DOUBLE_EQ(number("transients", 0), half_s - 0.25);
  const Effect spring = example(body, "nonlinear_stiffness");
  const auto& a = body.denominator;
  EXPECT_DOUBLE_EQ(spring.coefficients[0] / spring.value(0), -0.1 * (a[0] + a[1] + a[2]));
  EXPECT_DOUBLE_EQ(example({{{1.0}}, {1.0}}, "nonlinear_stiffness").value(0) * y * y, 0.1);
}

TEST(EveryEffectTest, EvidenceIsOneClauseWithFiniteNumbers) {
  for (const Effect& sut : made::every_effect()) {
    const std::string text = effect_kind(sut.kind).evidence(sut);
    EXPECT_FALSE(text.empty()) << name_of(sut);
    EXPECT_FALSE(text.ends_with(".")) << text;
    EXPECT_EQ(text.find(" nan"), std::string::npos) << text;
    EXPECT_EQ(text.find(" inf"), std::string::npos) << text;
  }
}

TEST(EveryEffectTest, EvidenceGivesTheNumberInItsUnit) {
  const auto says = [](const Effect& effect) { return effect_kind(effect.kind).evidence(effect); };
  // Seconds in the model, milliseconds in the sentence.
  EXPECT_NE(says({"delay", "", {}, {{"delay", "s", 0.0371}}, {}}).find("37.1 ms"),
            std::string::npos);
  // From 1 - 0.25 to 1 + 0.25: 5/3.
  const Effect step{"regime_change", "", {}, {{"time", "s", 4.0}, {"change", "-", 0.25}}, {}};
  EXPECT_NE(says(step).find("1.67"), std::string::npos);
  EXPECT_NE(says(step).find("4 s"), std::string::npos);
  // A frequency of 2.5 per rad: a period of 0.4 rad; amplitude hypot(3, 4) = 5.
  const Effect ripple{
      "position_ripple", "one harmonic", {"theta"}, {{"f", "1/rad", 2.5}}, {3.0, 4.0}};
  EXPECT_NE(says(ripple).find("0.4 rad"), std::string::npos);
  EXPECT_NE(says(ripple).find("theta"), std::string::npos);
  EXPECT_NE(says(ripple).find("5 (output unit)"), std::string::npos);
  // Of many bursts the first five.
  Effect bursts{"transients", "isolated bursts", {}, {}, {}};
  const auto add_burst = [&](double begin_s) {
    bursts.parameters.push_back(constant("begin", "s", begin_s));
    bursts.parameters.push_back(constant("end", "s", begin_s + 0.5));
  };
  for (const double begin_s : {3.0, 8.0}) add_burst(begin_s);
  EXPECT_EQ(says(bursts),
            "2 isolated burst(s), from 3 s, 8 s; the errors are of the rest of the record");
  for (const double begin_s : {11.0, 12.0, 13.0, 14.0}) add_burst(begin_s);
  EXPECT_TRUE(says(bursts).starts_with("6 isolated burst(s), from 3 s, 8 s, 11 s, 12 s, 13 s;"));
  // Within 2 % of its square, DG-25, it is called so.
  const auto square = [&](double share) {
    return says(made::effect_of("asymmetry", "square at the input", {"u"},
                                {{"square_share", "-", share}, {"largest_input", "V", 3.0}}));
  };
  for (const double share : {0.981, 1.019}) {
    EXPECT_EQ(square(share), "u acts by its square, within 2 % of it at 3 V");
  }
  EXPECT_EQ(square(0.979), "u acts by itself and its square, 0.979 of the square at 3 V");
  EXPECT_EQ(square(1.03), "u acts by itself and its square, 1.03 of the square at 3 V");
  // The sign of a friction is in the words, its size in the number.
  const Effect friction{"coulomb_friction", "sign", {"omega"}, {}, {-0.4}};
  EXPECT_NE(says(friction).find("0.4 (output unit) against"), std::string::npos);
}

}  // namespace stillhand::diagnosis::every_effect_test
