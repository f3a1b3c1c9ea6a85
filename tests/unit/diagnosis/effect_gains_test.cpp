// SPDX-License-Identifier: Apache-2.0
// Gains over the record, Eq. DG-5, the input's time, Eq. DG-2, and weights, tick by tick.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "services/core/diagnosis/model/effect_kind.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::effect_gains_test {

constexpr std::size_t kCount = 801;  // 8 s from the first to the last sample
constexpr double kPi = std::numbers::pi;

Signals signals_from(double start_s) {
  Measurement measurement = made::measurement_of({{"u", "m/s^2", made::white(kCount, 1)},
                                                  {"temp", "degC", made::white(kCount, 2)},
                                                  {"y", "N", made::white(kCount, 3)}});
  measurement.stretches.front().start_s = start_s;
  return {measurement, {"u"}, "y"};
}

std::vector<double> gain_of(const Effect& effect, const Signals& signals, double before = 1.0) {
  std::vector<double> gain(signals.size(), before);
  effect_kind(effect.kind).gain(effect, signals, gain);
  return gain;
}

Effect step_of(double at_s, double change) {
  return {"regime_change",
          "step of the gain",
          {},
          {{"time", "s", at_s, 0.0, 9.0, false}, {"change", "-", change, -5.0, 5.0}},
          {}};
}

// 0.25 s steps are exact in binary: sample 200 is at 2 s to the last bit.
TEST(EffectGainsTest, AStepComesWithTheSampleOfItsTime) {
  const auto sut = gain_of(step_of(2.0, 0.25), signals_from(0.0));
  EXPECT_EQ(sut[0], 0.75);
  EXPECT_EQ(sut[199], 0.75);
  EXPECT_EQ(sut[200], 1.25);
  EXPECT_EQ(sut[kCount - 1], 1.25);
}

TEST(EffectGainsTest, AStepAtTheEndsIsOneGainForAllThatIsMultipliedNotSet) {
  const Signals signals = signals_from(0.0);
  for (const double each : gain_of(step_of(0.0, 0.25), signals)) ASSERT_EQ(each, 1.25);
  for (const double each : gain_of(step_of(8.5, 0.25), signals, 2.0)) ASSERT_EQ(each, 1.5);
}

TEST(EffectGainsTest, ALinearGainIsOneInTheMiddle) {
  const auto sut =
      gain_of({"time_varying_gain", "linear", {}, {{"change", "-", 0.5}}, {}}, signals_from(0.0));
  EXPECT_EQ(sut.front(), 0.5);
  EXPECT_EQ(sut[400], 1.0);
  EXPECT_EQ(sut[600], 1.25);
  EXPECT_EQ(sut.back(), 1.5);
}

// 1 + sum c_k cos(pi k t), t from 0 to 1: three roundings below 2.
TEST(EffectGainsTest, SlowCosinesAddUp) {
  const auto sut =
      gain_of(made::effect_of("time_varying_gain", "slow cosines", {},
                              {{"half_cosine_1", "-", 0.2}, {"half_cosine_2", "-", -0.1}}),
              signals_from(0.0));
  for (std::size_t n = 0; n < kCount; ++n) {
    const double t = static_cast<double>(n) / 800.0;
    ASSERT_NEAR(sut[n], 1.0 + 0.2 * std::cos(kPi * t) - 0.1 * std::cos(2.0 * kPi * t), 1e-14) << n;
  }
}

// The first parameter is the number of cycles and no weight.
TEST(EffectGainsTest, ASinusoidalGainHasWholeCyclesOverTheRecord) {
  const auto sut = gain_of(
      made::effect_of("time_varying_gain", "sinusoidal", {},
                      {{"cycles_per_record", "-", 2.0}, {"sine", "-", 0.3}, {"cosine", "-", 0.1}}),
      signals_from(0.0));
  EXPECT_DOUBLE_EQ(sut[0], 1.1);
  EXPECT_NEAR(sut[100], 1.3, 1e-14) << "a quarter of a cycle";
  EXPECT_NEAR(sut[200], 0.9, 1e-14);
  EXPECT_NEAR(sut[300], 0.7, 1e-14);
  EXPECT_NEAR(sut[800], 1.1, 1e-14);
}

TEST(EffectGainsTest, AGainFollowsAChannelFromItsCentre) {
  const Signals signals = signals_from(0.0);
  const auto sut =
      gain_of(made::effect_of("bilinear", "gain of the body", {"temp"},
                              {{"sensitivity", "1/degC", 0.5}, constant("centre", "degC", 0.25)}),
              signals);
  for (std::size_t n = 0; n < kCount; ++n) {
    ASSERT_EQ(sut[n], 1.0 + 0.5 * (signals.at("temp").values[n] - 0.25)) << n;
  }
}

// A record that begins at 64 s, exact in binary, has the gains of one that begins at 0: times of
// gains count from its start.
TEST(EffectGainsTest, GainsCountTimeFromTheRecordsStart) {
  const Effect linear{"time_varying_gain", "linear", {}, {{"change", "-", 0.5}}, {}};
  const Signals early = signals_from(0.0);
  const Signals late = signals_from(64.0);
  const auto before = gain_of(linear, early);
  const auto after = gain_of(linear, late);
  // Times near 64 s are rounded to 1.4e-14 s, of 8 s.
  for (std::size_t n = 0; n < kCount; ++n) ASSERT_NEAR(after[n], before[n], 1e-14) << n;
  EXPECT_EQ(gain_of(step_of(2.0, 0.25), late)[200], 1.25);
  EXPECT_EQ(gain_of(step_of(2.0, 0.25), late)[199], 0.75);
}

TEST(EffectGainsTest, AClockDriftIsCountedFromItsReferenceTime) {
  const Effect sut =
      made::effect_of("clock_drift", "of the output", {},
                      {{"drift", "us/s", 500.0}, constant("reference_time", "s", 30.0)});
  const EffectKind& kind = effect_kind(sut.kind);
  EXPECT_EQ(kind.input_delay_s(sut, 30.0), 0.0);
  EXPECT_DOUBLE_EQ(kind.input_delay_s(sut, 130.0), 0.05);
  EXPECT_DOUBLE_EQ(kind.input_delay_s(sut, 10.0), -0.01);
}

// Eq. DG-68.
TEST(EffectGainsTest, AnEffectActsWithItsShare) {
  Effect late{"delay", "of the input", {}, {{"delay", "s", 0.125}}, {}};
  late.share = 0.5;
  EXPECT_EQ(delay_in_part(late, 3.0), 0.0625);
  Effect slopes{"asymmetry", "slopes at the output", {}, {{"slope_change", "-", 0.5}}, {}};
  slopes.share = 0.25;
  EXPECT_EQ(mapped_in_part(effect_kind("asymmetry"), slopes, -2.0), -1.75);
  EXPECT_EQ(slope_in_part(effect_kind("asymmetry"), slopes, -2.0), 0.875);
  Effect step = step_of(2.0, 0.25);
  step.share = 0.5;
  std::vector<double> gain(kCount, 2.0);
  gain_in_part(step, signals_from(0.0), gain);
  EXPECT_EQ(gain[199], 2.0 * 0.875);
  EXPECT_EQ(gain[200], 2.0 * 1.125);
}

// [begin, end) of every burst; the times are exact in binary.
TEST(EffectGainsTest, ABurstLeavesOutItsBeginAndKeepsItsEnd) {
  const Signals signals = signals_from(0.0);
  const Effect sut{
      "transients",
      "isolated bursts",
      {},
      {{"begin_1", "s", 1.0}, {"end_1", "s", 1.25}, {"begin_2", "s", 7.75}, {"end_2", "s", 99.0}},
      {}};
  std::vector<double> weight(kCount, 0.5);
  effect_kind("transients").weigh(sut, signals, weight);
  EXPECT_EQ(weight[99], 0.5);
  EXPECT_EQ(weight[100], 0.0);
  EXPECT_EQ(weight[124], 0.0);
  EXPECT_EQ(weight[125], 0.5);
  EXPECT_EQ(weight[774], 0.5);
  EXPECT_EQ(weight[775], 0.0);
  EXPECT_EQ(weight[kCount - 1], 0.0);
}

TEST(EffectGainsTest, WhatIsNoBurstLeavesTheWeightsAndABurstTheGain) {
  const Signals signals = signals_from(0.0);
  const std::vector<double> ones(kCount, 1.0);
  EXPECT_EQ(gain_of({"transients", "", {}, {{"b", "s", 1.0}, {"e", "s", 2.0}}, {}}, signals), ones);
  for (const Effect& sut : {Effect{"transients", "", {}, {}, {}}, step_of(2.0, 0.5)}) {
    std::vector<double> weight = ones;
    effect_kind(sut.kind).weigh(sut, signals, weight);
    EXPECT_EQ(weight, ones) << sut.kind;
  }
}

}  // namespace stillhand::diagnosis::effect_gains_test
