// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/no_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <vector>

#include "services/core/diagnosis/alignment.hpp"
#include "services/core/diagnosis/before_effects.hpp"
#include "services/core/diagnosis/diagnose.hpp"
#include "services/core/diagnosis/limit.hpp"
#include "services/core/diagnosis/share_words.hpp"
#include "tests/support/spoiled_recordings.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::no_model_test {

Measurement measured(const spoiled::Case& each) {
  const recording::Recording rows = spoiled::recorded(each);
  Measurement out;
  out.source = each.name;
  out.rate_hz = spoiled::kRate_hz;
  for (const recording::Column& column : rows.columns) {
    out.channels.push_back({column.name, column.unit, column.values});
  }
  out.weight.assign(spoiled::kRows, 1.0);
  out.stretches = {{0, spoiled::kRows, 0.0}};
  return out;
}

const spoiled::Case& named(const std::string& name) {
  return *std::ranges::find(spoiled::cases(), name, &spoiled::Case::name);
}

TEST(NoModelTest, AGoodRecordingHasAModel) {
  EXPECT_EQ(diagnose(measured(named("as it is")), {}).verdict(), "nothing missing");
}

TEST(NoModelTest, UnrelatedChannelsClocksAndUnitsAreNamed) {
  for (const auto& [name, reason] :
       {std::pair{"two seconds late", "clocks"}, std::pair{"two seconds early", "clocks"},
        std::pair{"a clock 1.5 % slow", "clocks"}, std::pair{"thousandths of newtons", "unit"},
        std::pair{"thousands of newtons", "unit"}, std::pair{"mm/s^2", "unit"},
        std::pair{"another recording's force", "unrelated"},
        std::pair{"noise for a signal", "unrelated"}, std::pair{"columns exchanged", "swapped"}}) {
    const Diagnosis sut = diagnose(measured(named(name)), {});
    EXPECT_EQ(sut.verdict(), "no model") << name;
    ASSERT_TRUE(sut.no_model) << name;
    EXPECT_EQ(sut.no_model->reason, reason) << name << ": " << sut.no_model->why;
    EXPECT_TRUE(sut.effects.empty()) << name;
  }
}

// The classic test signal stays at its two levels by design.
TEST(NoModelTest, ABinaryInputIsNoSensorAtItsLimit) {
  std::vector<double> input, output;
  std::uint32_t shift = 1;
  double lagged = 0.0;
  for (int n = 0; n < 6000; ++n) {
    if (n % 10 == 0) shift = shift >> 1 ^ (-(shift & 1) & 0xB400u);
    input.push_back((shift & 1) != 0 ? 1.0 : -1.0);
    lagged += 0.1 * (input.back() - lagged);
    output.push_back(lagged);
  }
  EXPECT_EQ(limit_in_words("a_y", input, "f", output, 100.0), "");
}

// y = 2 p + 0.5 for p from -1.7 to 2.3, cut off at c below the middle, 1.1, and 1.1 c above it; the
// middle half is free.  For one c the line through it has a gain of 2/1.05^4: from there the gains
// that are tried meet 2.
TEST(NoModelTest, ALimitIsThatOfAPredictionCutOff) {
  std::vector<double> p, y(401);
  for (int i = 0; i <= 400; ++i) p.push_back(-1.7 + 0.01 * i);
  double less = 2.0;
  double more = 3.6;
  while (more - less > 1e-13) {
    const double c = 0.5 * (less + more);
    for (std::size_t n = 0; n < y.size(); ++n) {
      y[n] = std::clamp(2.0 * p[n] + 0.5, 1.1 - c, 1.1 + 1.1 * c);
    }
    (likeness(p, y).gain < 2.0 / std::pow(1.05, 4) ? less : more) = c;
  }
  const Limit sut = limit_of(y, p);
  EXPECT_NEAR(sut.low, 1.1 - less, 1e-9);
  EXPECT_NEAR(sut.high, 1.1 + 1.1 * less, 1e-9);
  EXPECT_NEAR(sut.error_ratio, 0.0, 1e-9);
  const auto beyond = std::ranges::count(y, y.front()) + std::ranges::count(y, y.back());
  EXPECT_DOUBLE_EQ(sut.share, static_cast<double>(beyond) / 401.0);
}

// A ride that its sensor cuts off at 1 and 3 deviations, behind noise: 32 % and 0.3 % lie beyond.
TEST(NoModelTest, AnInputThatGoesOnBeyondItsLimitShowsInTheOutput) {
  const auto is_named = [](double limit, std::size_t rows) {
    auto u = made::ride(rows, 1);
    const auto force = made::answer(made::two_pole_body(), u);
    for (double& each : u) each = std::clamp(each, -limit, limit);
    u = made::mix({{1.0, u}, {0.02, made::white(rows, 2)}});
    return !limit_in_words("a_y", u, "f", force, made::kRateHz).empty();
  };
  EXPECT_TRUE(is_named(1.0, 1000)) << "10 s";
  EXPECT_FALSE(is_named(1.0, 998));
  EXPECT_FALSE(is_named(3.0, 6000));
}

constexpr double kHeaviest_kg = 200.0;

// Of y = gain u(t - lag) and noise that is `left` of its power, u a ride, by a static model.
// @param end  after the search, or before it
std::string reason_of(double gain, double lag_s, double left, bool end) {
  const auto u = made::ride(6000, 1);
  const auto y = made::mix({{gain, moved(u, made::kRateHz, {lag_s, 0.0, 0.0})},
                            {gain * std::sqrt(left / (1.0 - left)), made::white(6000, 2)}});
  const Measurement asked = made::measurement_of({{"u", "m/s^2", u}, {"y", "N", y}});
  const made::Studied of(asked, 0);
  const Model& model = of.baseline.model;
  auto no =
      end ? no_model_of(asked, of.signals, of.blocks, model, of.screening.rmse(), 0, kHeaviest_kg)
          : exchanged_of(asked, of.signals, of.blocks, model, 0, kHeaviest_kg);
  if (!no && !end) no = late_of(asked, of.signals, of.blocks, model, 0);
  return no ? no->reason : "";
}

// 1 s late: another clock must leave less than a fifth.  0.3 s is a body's lag.  0.04 and 0.08 s
// early: the future must leave less than a tenth of the 0.83 that a static model leaves at 0.04 s.
// In the end 6 % must be explained.  The gain is a mass, which is judged if half is explained: 220
// kg are more than the heaviest.
TEST(NoModelTest, AnotherReadingHasToExplainMostOfTheRest) {
  for (const auto& [gain, lag_s, left, end, reason] : {std::tuple{1.0, 1.0, 0.15, false, "clocks"},
                                                       {1.0, 1.0, 0.3, false, ""},
                                                       {1.0, 0.3, 0.05, false, ""},
                                                       {1.0, -0.04, 0.05, false, "clocks"},
                                                       {1.0, -0.08, 0.05, false, "clocks"},
                                                       {1.0, -0.04, 0.13, false, ""},
                                                       {1.0, 0.0, 0.9, true, ""},
                                                       {1.0, 0.0, 0.97, true, "unrelated"},
                                                       {150.0, 0.0, 0.45, true, ""},
                                                       {220.0, 0.0, 0.45, true, "unit"},
                                                       {220.0, 0.0, 0.55, true, ""}}) {
    EXPECT_EQ(reason_of(gain, lag_s, left, end), reason) << gain << ", " << lag_s << ", " << left;
  }
}

Measurement renamed(Measurement measurement) {
  measurement.channels[0].name = "Acc Y";
  measurement.channels[1].name = "Grip force";
  return measurement;
}

TEST(NoModelTest, AUnitIsNamedUnderAnyNameOfTheColumns) {
  DiagnoseOptions options;
  options.inputs = {"Acc Y"};
  options.output = "Grip force";
  options.search.most_effects = 0;
  const Diagnosis sut = diagnose(renamed(measured(named("thousands of newtons"))), options);
  ASSERT_TRUE(sut.no_model);
  EXPECT_EQ(sut.no_model->reason, "unit");
  EXPECT_THAT(why_unchecked({"Acc Y", "V", 0.0, "Grip force", "N", 0.0}),
              testing::HasSubstr("units not checked, because"));
}

// Of a force behind a dead zone, with which an effect would be found.
Measurement late_by(std::ptrdiff_t rows) {
  Measurement out = measured(named("as it is"));
  std::vector<double>& force = out.channels[1].values;
  for (double& value : force) value = std::copysign(std::max(std::abs(value) - 0.5, 0.0), value);
  std::ranges::rotate(force, rows > 0 ? force.end() - rows : force.begin() - rows);
  return out;
}

TEST(NoModelTest, AForceThatIsLateOrEarlyIsNamedBeforeAnEffectIsTried) {
  for (const std::ptrdiff_t rows : {100, 200, -20}) {
    const Diagnosis sut = diagnose(late_by(rows), {});
    ASSERT_TRUE(sut.no_model) << rows << ": " << sut.verdict();
    EXPECT_TRUE(sut.no_model->reason == "clocks" || (rows < 0 && sut.no_model->reason == "swapped"))
        << rows << ": " << sut.no_model->why;
    EXPECT_EQ(sut.options.search.most_effects, 0u) << rows;
    EXPECT_TRUE(sut.effects.empty()) << rows;
  }
}

TEST(NoModelTest, ADeadZoneThatIsNotLateHasItsEffect) {
  const Diagnosis sut = diagnose(late_by(0), {});
  EXPECT_EQ(sut.verdict(), "effects found") << (sut.no_model ? sut.no_model->why : "");
}

TEST(NoModelTest, ACopyOfTheInputIsNamed) {
  Measurement copy = measured(named("as it is"));
  for (std::size_t n = 0; n < copy.size(); ++n) {
    copy.channels[1].values[n] = std::round(20.0 * copy.channels[0].values[n] * 1e3) / 1e3;
  }
  const Diagnosis sut = diagnose(copy, {});
  ASSERT_TRUE(sut.no_model) << sut.verdict();
  EXPECT_EQ(sut.no_model->reason, "copy");
  // A thousandth of noise is what two sensors of a rigid mass have at least.
  spoiled::Dice dice;
  for (double& value : copy.channels[1].values) value += 0.1 * (dice.next() - 0.5);
  EXPECT_NE(diagnose(copy, {}).verdict(), "no model");
}

TEST(NoModelTest, AShareOfAnErrorThatRanAwayIsWords) {
  EXPECT_EQ(share_in_words(0.9762), "97.6 %");
  EXPECT_EQ(share_in_words(-5.36e6), "nothing (worse than the mean)");
  EXPECT_EQ(vaf_in_words(97.616), "VAF 97.62 %");
  EXPECT_EQ(vaf_in_words(-1e34), "VAF below -100 % (worse than the mean)");
}

// The effect of that name, or the reason: in both directions.
TEST(NoModelTest, ClocksThatRunApartAreFoundInBothDirections) {
  for (const char* name : {"a clock 0.83 % fast", "a clock 0.83 % slow", "a clock 1.5 % fast"}) {
    const Diagnosis sut = diagnose(measured(named(name)), {});
    if (sut.no_model) {
      EXPECT_EQ(sut.no_model->reason, "clocks") << name << ": " << sut.no_model->why;
    } else {
      ASSERT_FALSE(sut.effects.empty()) << name;
      EXPECT_EQ(sut.effects.front().effect.kind, "clock_drift") << name;
    }
  }
}

// A recording, and the same with its force times `by`.
Measurement joined(double by) {
  Measurement out = measured(named("as it is"));
  for (Channel& channel : out.channels) {
    const std::vector<double> values = channel.values;
    for (const double value : values) {
      channel.values.push_back(channel.name == "f" ? by * value : value);
    }
  }
  out.weight.assign(2 * spoiled::kRows, 1.0);
  out.stretches.push_back({spoiled::kRows, 2 * spoiled::kRows, 100.0, 1});
  return out;
}

// Persons differ by less than a unit does.
TEST(NoModelTest, ASignOrAUnitOfOneOfTwoRecordingsIsNamed) {
  for (const auto& [by, reason] :
       {std::pair{-1.0, "sign"}, std::pair{4.448, "unit"}, std::pair{1e-3, "unit"},
        std::pair{9.81, "unit"}, std::pair{1.0, ""}, std::pair{2.0, ""}}) {
    const Diagnosis sut = diagnose(joined(by), {});
    EXPECT_EQ(sut.no_model ? sut.no_model->reason : "", reason) << by << ": " << sut.verdict();
  }
}

// Unsound samples end the search before an effect is named.
TEST(NoModelTest, UnsoundSamplesHaveNoModelAndNoEffect) {
  Measurement held = measured(named("held at 25 Hz"));
  held.screening = {{"a_y", "held", {0.0}, 1.0, "a_y: held", true}};
  const Diagnosis sut = diagnose(held, {});
  EXPECT_EQ(sut.verdict(), "no model");
  EXPECT_EQ(sut.no_model->reason, "samples");
  EXPECT_TRUE(sut.effects.empty());
}

// n^2 at 10 Hz: halfway between two samples the mean of both; the ends are held.
TEST(AlignmentTest, AMovedSignalIsInterpolated) {
  const auto sut = [](const Alignment& by) { return moved({0, 1, 4, 9, 16, 25}, 10.0, by); };
  const auto is = [](const std::vector<double>& x) {
    return testing::Pointwise(testing::DoubleNear(1e-9), x);
  };
  EXPECT_THAT(sut({0.25, 0.0, 0.2}), is({0.0, 0.0, 0.0, 0.5, 2.5, 6.5}));
  EXPECT_THAT(sut({-0.15, 0.0, 0.2}), is({2.5, 6.5, 12.5, 20.5, 25.0, 25.0}));
  EXPECT_THAT(sut({0.0, 0.5, 0.2}), is({1.0, 2.5, 4.0, 6.5, 9.0, 12.5})) << "from 1 by halves";
}

// To two of the last steps, 5 ms and 0.01 s over the record; to 10 s and a quarter of the record.
TEST(AlignmentTest, TheLagAndTheDriftAreThoseOfTheClock) {
  const auto sut = [](double lag_s, double drift, std::size_t rows = 6000, double rate_hz = 100.0) {
    const std::vector<double> x = made::ride(rows, 1);
    const double middle_s = 0.5 * static_cast<double>(rows) / rate_hz;
    return aligned(x, moved(x, rate_hz, {lag_s, drift, middle_s}), rate_hz);
  };
  for (const auto& [lag_s, drift] : {std::pair{9.5, 0.0}, {-9.5, 0.0}, {1.0, 0.015}}) {
    EXPECT_NEAR(sut(lag_s, drift).lag_s, lag_s, 0.01);
    EXPECT_NEAR(sut(lag_s, drift).drift, drift, 0.02 / 60.0);
  }
  EXPECT_LT(std::abs(sut(12.0, 0.0).lag_s), 10.1);
  EXPECT_LT(std::abs(sut(8.5, 0.0, 3000).lag_s), 7.6);
  EXPECT_NEAR(sut(1.5, 0.0, 6000, 20.0).lag_s, 1.5, 0.01);
  EXPECT_EQ(sut(1.5, 0.0, 6000, 19.9).lag_s, 0.0) << "a slow system lags by itself";
}

// A constant lag of -0.1 to 0.5 s, with 0.01 s over half of the record, is a body's; of another one
// 0 to 0.15 s are left to the body.
TEST(AlignmentTest, WhatABodyLagsIsNoClock) {
  EXPECT_THAT(readings({-0.099, 0.0, 30.0}), testing::IsEmpty());
  EXPECT_THAT(readings({0.499, 0.0099 / 30.0, 30.0}), testing::IsEmpty());
  EXPECT_THAT(readings({0.2, 0.0101 / 30.0, 30.0}), testing::SizeIs(4));
  EXPECT_THAT(readings({-0.101, 0.0, 30.0}), testing::SizeIs(4));
  const std::vector<Alignment> sut = readings({0.501, 0.02, 30.0});
  ASSERT_THAT(sut, testing::SizeIs(4));
  EXPECT_NEAR(sut[1].delay_s(31.0), 0.501 - 0.05 + 0.02, 1e-12);
  EXPECT_NEAR(sut[3].delay_s(29.0), 0.501 - 0.15 - 0.02, 1e-12);
}

// y = 3 x + z + 5, z of x's power and none of it: 9/10 of y's.
TEST(AlignmentTest, ALineHasItsGainAndItsShare) {
  const auto& [gain, share] = likeness({1.0, -1.0, 1.0, -1.0}, {9.0, 3.0, 7.0, 1.0});
  EXPECT_DOUBLE_EQ(gain, 3.0);
  EXPECT_DOUBLE_EQ(share, 0.9);
  EXPECT_EQ(likeness({1.0, 1.0}, {1.0, 2.0}).share, 0.0);
  EXPECT_EQ(likeness({1.0, 2.0}, {1.0, 1.0}).share, 0.0);
}

}  // namespace stillhand::diagnosis::no_model_test
