// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/model/signals.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/units.hpp"
#include "tests/support/refusal.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::signals_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

constexpr std::size_t kCount = 3001;

// amplitude sin(2 pi f t + phase), its first or second derivative.
std::vector<double> sine(double frequency_hz, int derivative = 0, double phase_rad = 0.4) {
  std::vector<double> x(kCount);
  const double w = kTwoPi * frequency_hz;
  for (std::size_t n = 0; n < kCount; ++n) {
    const double angle = w * static_cast<double>(n) / made::kRateHz + phase_rad;
    x[n] = std::pow(w, derivative) * std::sin(angle + derivative * std::numbers::pi / 2.0);
  }
  return x;
}

Signals with(std::vector<Channel> channels) {
  channels.insert(channels.begin(), {"u", "V", made::ride(kCount, 1)});
  channels.push_back({"y", "N", made::ride(kCount, 2)});
  return {made::measurement_of(std::move(channels)), {"u"}, "y"};
}

std::vector<std::string> names_of(const Signals& signals) {
  std::vector<std::string> names;
  for (const Signal& signal : signals.all()) names.push_back(signal.name);
  return names;
}

std::string error_of(const Measurement& measurement, const std::vector<std::string>& inputs,
                     const std::string& output) {
  return support::refusal([&] { const Signals signals(measurement, inputs, output); });
}

TEST(SignalsTest, AUnitSaysWhatAChannelIs) {
  for (const char* unit : {"m", "mm", "cm", "rad", "deg"}) {
    EXPECT_EQ(quantity_of(unit), Quantity::kPosition) << unit;
    EXPECT_EQ(quantity_of(std::string(unit) + "/s"), Quantity::kRate) << unit;
    EXPECT_EQ(quantity_of(std::string(unit) + "/s^2"), Quantity::kAcceleration) << unit;
  }
  for (const char* unit : {"", "N", "degC", "m^2", "m/s^3", "/s", "s", "1/m", "mol", "radian"}) {
    EXPECT_EQ(quantity_of(unit), Quantity::kOther) << unit;
  }
}

TEST(SignalsTest, InputsComeFirstAndTheOutputIsNotAmongThem) {
  const Signals sut = with({{"temp", "degC", made::ride(kCount, 3)}});
  EXPECT_THAT(names_of(sut), ElementsAre("u", "temp"));
  EXPECT_EQ(sut.output().name, "y");
  EXPECT_TRUE(sut.is_input("u"));
  EXPECT_FALSE(sut.is_input("temp"));
  EXPECT_EQ(&sut.at("temp"), &sut.all()[1]);
  EXPECT_THROW(static_cast<void>(sut.at("y")), ConfigError);
}

TEST(SignalsTest, MomentsAreThoseOfAllSamples) {
  const Signals sut(
      made::measurement_of({{"u", "V", {1.0, 2.0, 3.0, 6.0}}, {"y", "N", {0.0, 1.0, 0.0, 1.0}}}),
      {"u"}, "y");
  EXPECT_DOUBLE_EQ(sut.at("u").mean, 3.0);
  EXPECT_DOUBLE_EQ(sut.at("u").deviation, std::sqrt((4.0 + 1.0 + 0.0 + 9.0) / 4.0));
}

TEST(SignalsTest, AConstantChannelExplainsNothing) {
  EXPECT_THAT(names_of(with({{"temp", "degC", std::vector<double>(kCount, 20.0)}})),
              ElementsAre("u"));
  std::vector<double> rounded(kCount, 20.0);
  rounded[100] = std::nextafter(20.0, 21.0);
  EXPECT_THAT(names_of(with({{"temp", "degC", rounded}})), ElementsAre("u"));
}

// A stick's rate behind a filter, in a trial in which the stick is pegged.
TEST(SignalsTest, WhatAFiltersStartHasFadedToExplainsNothing) {
  std::vector<double> omega(kCount);
  for (std::size_t n = 0; n < kCount; ++n) {
    omega[n] =
        5e-94 * std::exp(-0.2 * static_cast<double>(n)) * std::cos(0.3 * static_cast<double>(n));
  }
  EXPECT_THAT(names_of(with({{"omega", "rad/s", omega}})), ElementsAre("u"));
}

// Central differences of sin(wt) over 2 T give w cos(wt) sinc(w T), 1 - (w T)^2/6 of it: 6.6e-4
// short at 1 Hz and 100 Hz.
TEST(SignalsTest, APositionImpliesItsRate) {
  const Signals sut = with({{"theta", "rad", sine(1.0)}});
  EXPECT_THAT(names_of(sut), ElementsAre("u", "theta", "rate of theta"));
  const Signal& rate = sut.at("rate of theta");
  EXPECT_EQ(rate.unit, "rad/s");
  EXPECT_EQ(rate.quantity, Quantity::kRate);
  EXPECT_EQ(rate.source, "theta");
  EXPECT_TRUE(rate.derived);
  const auto want = sine(1.0, 1);
  const double sinc = std::sin(kTwoPi / 100.0) / (kTwoPi / 100.0);
  for (std::size_t n = 1; n + 1 < kCount; ++n) ASSERT_NEAR(rate.values[n], sinc * want[n], 1e-10);
  // At the ends over one interval: half a sample off.
  EXPECT_NEAR(rate.values.front(), want.front(), kTwoPi * kTwoPi / 200.0);
  EXPECT_EQ(sut.rate_of(sut.at("theta")), &rate);
}

// Trapezoids of w cos(wt) give sin(wt) wT/2 / tan(wT/2), counted from the first sample.
TEST(SignalsTest, ARateImpliesItsPosition) {
  const Signals sut = with({{"omega", "rad/s", sine(1.0, 1)}});
  EXPECT_THAT(names_of(sut), ElementsAre("u", "omega", "position of omega"));
  const Signal& position = sut.at("position of omega");
  EXPECT_EQ(position.unit, "rad");
  EXPECT_EQ(position.quantity, Quantity::kPosition);
  const auto want = sine(1.0);
  const double half = kTwoPi / 200.0;
  for (std::size_t n = 0; n < kCount; ++n) {
    ASSERT_NEAR(position.values[n], half / std::tan(half) * (want[n] - want[0]), 1e-10) << n;
  }
}

// Behind the high-pass of second order at 0.1 Hz, 1/sqrt(1 + (0.1/f)^4); its start fades with
// e^(-0.44 t), to 1.4e-4 after 20 s; trapezoids and crests are off by (w T)^2 (1/12 + 1/8) at most.
TEST(SignalsTest, AnAccelerationImpliesItsRateWithoutDrift) {
  for (const double frequency_hz : {0.1, 1.0}) {
    std::vector<double> a = sine(frequency_hz, 2);
    for (double& value : a) value += 0.05;  // an accelerometer's offset
    const Signals sut = with({{"a_x", "m/s^2", a}});
    EXPECT_THAT(names_of(sut), ElementsAre("u", "a_x", "rate of a_x"));
    const Signal& rate = sut.at("rate of a_x");
    EXPECT_EQ(rate.unit, "m/s");
    double largest = 0.0;
    for (std::size_t n = 2000; n < kCount; ++n) {
      largest = std::max(largest, std::abs(rate.values[n]));
    }
    const double want = kTwoPi * frequency_hz / std::sqrt(1.0 + std::pow(0.1 / frequency_hz, 4));
    EXPECT_NEAR(largest, want, 2e-3 * want);
    EXPECT_NEAR(rate.mean, 0.0, 0.05) << "0.05 m/s^2 for 30 s would be 0.75 m/s in the mean";
  }
}

TEST(SignalsTest, AMeasuredSiblingMakesADerivedOneNeedless) {
  EXPECT_THAT(names_of(with({{"theta", "rad", sine(1.0)}, {"omega", "rad/s", sine(1.0, 1)}})),
              ElementsAre("u", "theta", "omega"));
  // An offset of the position doesn't make it another one.
  std::vector<double> shifted = sine(1.0);
  for (double& x : shifted) x += 3.0;
  const Signals both = with({{"theta", "rad", shifted}, {"omega", "rad/s", sine(1.0, 1)}});
  EXPECT_THAT(names_of(both), ElementsAre("u", "theta", "omega"));
  EXPECT_EQ(both.rate_of(both.at("theta")), &both.at("omega"));
  // A rate of something else does.
  EXPECT_THAT(names_of(with({{"theta", "rad", sine(1.0)}, {"v", "m/s", sine(3.3, 1)}})),
              ElementsAre("u", "theta", "v", "rate of theta", "position of v"));
}

TEST(SignalsTest, DerivedSignalsDoNotReachOverAGap) {
  const Measurement measurement =
      made::cut_in_two(made::measurement_of({{"u", "V", {1.0, 2.0, 1.0, 2.0, 1.0, 2.0}},
                                             {"x", "m", {0.0, 1.0, 4.0, 100.0, 101.0, 104.0}},
                                             {"v", "rad/s", {1.0, 1.0, 3.0, 2.0, 2.0, 4.0}},
                                             {"y", "N", {1.0, 0.0, 1.0, 0.0, 1.0, 1.0}}},
                                            1.0),
                       3, 10.0);
  const Signals sut(measurement, {"u"}, "y");
  EXPECT_THAT(sut.at("rate of x").values, ElementsAre(1.0, 2.0, 3.0, 1.0, 2.0, 3.0));
  EXPECT_THAT(sut.at("position of v").values, ElementsAre(0.0, 1.0, 3.0, 0.0, 2.0, 5.0));
}

// The first second of a stretch, at most a tenth of it.
TEST(SignalsTest, TheStartOfAStretchIsNotJudged) {
  Measurement measurement =
      made::measurement_of({{"u", "V", made::ride(kCount, 1)}, {"y", "N", made::ride(kCount, 2)}});
  measurement.weight[1500] = 0.0;
  const Signals sut(made::cut_in_two(measurement, 2600, 5.0), {"u"}, "y");
  for (std::size_t n = 0; n < kCount; ++n) {
    const bool judged = n >= 100 && n != 1500 && !(n >= 2600 && n < 2640);
    ASSERT_EQ(sut.weight()[n], judged ? 1.0 : 0.0) << n;
  }
  EXPECT_DOUBLE_EQ(sut.duration_s(), 30.0 + 5.0);
}

TEST(SignalsTest, ARestartBeginsAStretchThatIsNotJudgedAtFirst) {
  const Measurement measurement =
      made::measurement_of({{"u", "V", made::ride(kCount, 1)}, {"y", "N", made::ride(kCount, 2)}});
  const Signals signals(made::cut_in_two(measurement, 2600, 5.0), {"u"}, "y");
  // A border of a stretch, and one beyond the end, add nothing.
  const Signals sut = signals.restarted({1000, 1400, 2600, kCount});
  std::vector<std::pair<std::size_t, std::size_t>> stretches;
  for (const Stretch& stretch : sut.stretches()) {
    stretches.emplace_back(stretch.first, stretch.end);
    EXPECT_EQ(stretch.start_s, sut.time_s()[stretch.first]);
  }
  EXPECT_THAT(stretches,
              ElementsAre(Pair(0, 1000), Pair(1000, 1400), Pair(1400, 2600), Pair(2600, kCount)));
  EXPECT_EQ(sut.weight()[1039], 0.0);  // a tenth of 400 samples is less than a second
  EXPECT_EQ(sut.weight()[1040], 1.0);
  EXPECT_EQ(sut.weight()[1499], 0.0);
  EXPECT_EQ(sut.weight()[1500], 1.0);
  EXPECT_EQ(signals.weight()[1020], 1.0);
}

// Eq. DG-60: ten seconds, or what a short stretch has.
TEST(SignalsTest, APastIsTheBeginningOfItsStretchInReverseAndFades) {
  std::vector<double> offset = made::ride(kCount, 3);
  for (double& x : offset) x = 7.0 + 0.01 * x;
  const auto measurement = made::measurement_of(
      {{"u", "V", made::ride(kCount, 1)}, {"v", "V", offset}, {"y", "N", made::ride(kCount, 2)}});
  const Signals signals(made::cut_in_two(measurement, 400, 5.0), {"u"}, "y");
  const Signals sut = signals.with_pasts();
  ASSERT_EQ(sut.stretches().size(), 2);
  EXPECT_EQ(sut.stretches()[0].end, 399 + 400);
  EXPECT_EQ(sut.stretches()[1].first, 799);
  EXPECT_EQ(sut.size(), 399 + 1000 + kCount);
  const std::vector<double>& u = signals.inputs()[0].values;  // it swings about 0
  for (std::size_t n = 1; n < 100; ++n) {
    const double left = 0.5 + 0.5 * std::cos(0.01 * std::numbers::pi * static_cast<double>(n));
    EXPECT_NEAR(sut.inputs()[0].values[399 - n], left * u[n], 1e-12);
  }
  for (std::size_t n = 100; n < 400; ++n) EXPECT_EQ(sut.inputs()[0].values[399 - n], 0.0);
  for (std::size_t n = 0; n < 400; ++n) EXPECT_EQ(sut.inputs()[0].values[399 + n], u[n]);
  EXPECT_NEAR(sut.at("v").values[799], 7.0, 0.01);  // an offset is the level before
  EXPECT_EQ(sut.weight()[399 + 100], signals.weight()[100]);
  for (std::size_t n = 0; n < 399; ++n) EXPECT_EQ(sut.weight()[n], 0.0);
  // From 4 s and a pause of 5 s, later by the first past.
  EXPECT_EQ(sut.time_s()[0], 0.0);
  EXPECT_NEAR(sut.time_s()[799], 9.0 + 3.99, 1e-9);
  for (std::size_t n = 1; n < sut.size(); ++n) EXPECT_GT(sut.time_s()[n], sut.time_s()[n - 1]);
  EXPECT_EQ(signals.without_pasts(sut.output().values), signals.output().values);
  EXPECT_EQ(signals.without_pasts(sut.weight()), signals.weight());
}

// Outside the band lies a hundredth of the power on each side: for sines of equal power at 1 and
// 4 Hz the lines themselves, 0.03 Hz apart.
TEST(SignalsTest, TheExcitedBandIsWhereTheInputHasItsPower) {
  std::vector<double> u = sine(1.0);
  const auto more = sine(4.0);
  for (std::size_t n = 0; n < kCount; ++n) u[n] += more[n] + 3.0;
  const Signals sut = made::signals_of(u, made::ride(kCount, 2));
  // Leakage of a record that isn't padded to whole cycles: a percent lies within three lines.
  EXPECT_NEAR(sut.lowest_excited_hz(), 1.0, 0.25);
  EXPECT_NEAR(sut.highest_excited_hz(), 4.0, 0.25);
}

TEST(SignalsTest, ChannelsThatAreNotThereAreNamedWithThoseThatAre) {
  const Measurement measurement =
      made::measurement_of({{"u", "V", made::ride(kCount, 1)}, {"y", "N", made::ride(kCount, 2)}});
  EXPECT_THAT(error_of(measurement, {"a_y"}, "y"),
              HasSubstr("'a_y', which isn't there, want one of u, y"));
  EXPECT_THAT(error_of(measurement, {"u"}, "f"), HasSubstr("output: got 'f'"));
  EXPECT_THAT(error_of(measurement, {"u"}, "u"), HasSubstr("'u', the output"));
  EXPECT_THAT(error_of(measurement, {"u", "u"}, "y"), HasSubstr("'u' twice"));
  EXPECT_THAT(error_of(measurement, {}, "y"), HasSubstr("at least one channel"));
}

TEST(SignalsTest, AMeasurementThatIsNoneIsRefusedBeforeItIsRead) {
  Measurement measurement =
      made::measurement_of({{"u", "V", made::ride(kCount, 1)}, {"y", "N", made::ride(kCount, 2)}});
  measurement.stretches[0].end = 2 * kCount;
  EXPECT_THAT(error_of(measurement, {"u"}, "y"), HasSubstr("stretches of 6002 samples"));
}

}  // namespace stillhand::diagnosis::signals_test
