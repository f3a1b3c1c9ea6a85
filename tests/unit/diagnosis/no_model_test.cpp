// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/no_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "services/core/diagnosis/alignment.hpp"
#include "services/core/diagnosis/diagnose.hpp"
#include "services/core/diagnosis/limit.hpp"
#include "services/core/diagnosis/share_words.hpp"
#include "tests/support/spoiled_recordings.hpp"

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

TEST(NoModelTest, ASignOrAUnitOfOneOfTwoRecordingsIsNamed) {
  for (const auto& [by, reason] : {std::pair{-1.0, "sign"}, std::pair{4.448, "unit"},
                                   std::pair{1e-3, "unit"}, std::pair{9.81, "unit"}}) {
    const Diagnosis sut = diagnose(joined(by), {});
    ASSERT_TRUE(sut.no_model) << by << ": " << sut.verdict();
    EXPECT_EQ(sut.no_model->reason, reason) << by << ": " << sut.no_model->why;
  }
}

// Persons differ by less than a unit does.
TEST(NoModelTest, RecordingsOfTwoPersonsHaveAModel) {
  EXPECT_FALSE(diagnose(joined(1.0), {}).no_model);
  EXPECT_FALSE(diagnose(joined(2.0), {}).no_model);
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

// The lag of the correlations' peak is that of the clock and up to 0.2 s of the body.
TEST(NoModelTest, TheLagAndTheDriftAreThoseOfTheClock) {
  const auto sut = [](const char* name) {
    const Measurement each = measured(named(name));
    return aligned(each.channels[0].values, each.channels[1].values, each.rate_hz);
  };
  EXPECT_NEAR(sut("two seconds late").lag_s, 2.1, 0.1);
  EXPECT_NEAR(sut("two seconds early").lag_s, -1.9, 0.1);
  // Two steps of the search over a minute are 0.01 s / 60 s.
  EXPECT_NEAR(sut("a clock 1.5 % slow").drift, -0.015, 3e-4);
  EXPECT_TRUE(readings(sut("as it is")).empty());
}

}  // namespace stillhand::diagnosis::no_model_test
