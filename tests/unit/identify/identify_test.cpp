// SPDX-License-Identifier: Apache-2.0
#include "apps/identify/identify.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <utility>
#include <vector>

#include "apps/identify/identify_output.hpp"
#include "apps/libraries/measurement/grid.hpp"
#include "apps/libraries/measurement/sample_screen.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/rig/parts/body.hpp"
#include "services/core/rig/parts/body_response.hpp"
#include "tests/support/feedthrough_records.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/spoiled_recordings.hpp"

namespace stillhand::identify::identify_test {
namespace {

using diagnosis::Measurement;
using testing::Contains;
using testing::HasSubstr;

Measurement measured(double rate_hz, std::vector<double> input, std::vector<double> output) {
  Measurement out;
  out.source = "pegged.csv";
  out.rate_hz = rate_hz;
  out.weight.assign(input.size(), 1.0);
  out.stretches = {{0, input.size(), 0.0}};
  out.channels = {{"a_y", "m/s^2", std::move(input)}, {"f", "N", std::move(output)}};
  return out;
}

// Forty seconds of the simulated body with the stick pegged, 0.05 N of noise, 1 kHz.
Measurement pegged_body() {
  rig::Body body{rig::BodyConfig{}, rig::StickConfig{}};
  const auto accel = support::band_noise(40'000, 1000.0, 0.7, 4.0, 1.6, 1);
  auto force = support::white_noise(accel.size(), 0.05, 2);
  for (std::size_t n = 0; n < accel.size(); ++n) {
    force[n] += body.step({accel[n], 0.0, 0.0, true}).hand_force_n;
  }
  return measured(1000.0, accel, force);
}

std::string error_of(const Measurement& measurement, const IdentifyOptions& options = {}) {
  return support::refusal([&] { (void)identify(measurement, options); });
}

TEST(IdentifyTest, TheBodysResponseIsFoundAndItsNotch) {
  const IdentifyResult sut = identify(pegged_body(), {});
  EXPECT_EQ(sut.model.fit.order(), 4u);
  EXPECT_TRUE(sut.unusable.empty());
  EXPECT_GT(sut.model.heldout.free_run_vaf_percent, 99.0);
  const auto truth = [](double f) {
    return rig::feedthrough_response(rig::BodyConfig{}, rig::StickConfig{}, true, f);
  };
  // As the identification's own test: within 1 % where the motion excites.
  for (const auto& point : sut.response) {
    if (point.frequency_hz < 0.7 || point.frequency_hz > 4.0) continue;
    const auto found = std::polar(std::pow(10.0, point.magnitude_db / 20.0),
                                  point.phase_deg * 3.14159265358979 / 180.0);
    EXPECT_LT(std::abs(found - truth(point.frequency_hz)), 0.01 * 3.2) << point.frequency_hz;
  }
  EXPECT_NEAR(sut.dc_gain_db, 20.0 * std::log10(std::abs(truth(0.01))), 0.2);
  // The body's own notch, by search; the motion hardly reaches it.
  double notch_hz = 4.0;
  for (double f = 4.0; f < 9.0; f += 0.01) {
    if (std::abs(truth(f)) < std::abs(truth(notch_hz))) notch_hz = f;
  }
  ASSERT_TRUE(sut.notch.has_value());
  EXPECT_NEAR(sut.notch->frequency_hz, notch_hz, 0.3);
}

TEST(IdentifyTest, TheMeasuredResponseStandsBesideTheModels) {
  const IdentifyResult sut = identify(pegged_body(), {});
  for (std::size_t k = 0; k < sut.measured.frequency_hz.size(); ++k) {
    const double f = sut.measured.frequency_hz[k];
    if (f < 1.0 || f > 3.5) continue;
    EXPECT_GT(sut.measured.coherence[k], 0.95) << f;
    const auto model = signal::response_at(sut.model.fit, f);
    // Leakage between lines of 0.2 Hz beside a resonance 0.5 Hz wide: a few percent.
    EXPECT_LT(std::abs(sut.measured.response[k] - model), 0.1 * std::abs(model)) << f;
  }
}

TEST(IdentifyTest, AModelWithoutANotchHasNone) {
  const auto low_pass = signal::DifferenceModel{50.0, {0.2, 0.0}, {1.0, -0.8}};
  auto record = support::record_of(low_pass, support::white_noise(6000, 1.0, 3));
  // Held for two samples: 100 Hz, which the chain takes down to 50 Hz again.
  std::vector<double> input;
  std::vector<double> output;
  for (std::size_t n = 0; n < record.size(); ++n) {
    input.insert(input.end(), 2, record.acceleration_m_s2[n]);
    output.insert(output.end(), 2, record.force_n[n]);
  }
  IdentifyOptions options;
  options.config.order = 1;
  EXPECT_FALSE(identify(measured(100.0, input, output), options).notch.has_value());
}

// The check for excitation knows m/s^2: 5 mV would be none.
TEST(IdentifyTest, AnInputInAnotherUnitIsJudgedByItsShapeAlone) {
  const Measurement plain = pegged_body();
  Measurement volts = plain;
  volts.channels[0].name = "drive";
  volts.channels[0].unit = "V";
  for (double& value : volts.channels[0].values) value *= 1e-3;
  IdentifyOptions options;
  options.input = "drive";
  const IdentifyResult sut = identify(volts, options);
  const IdentifyResult in_m_s2 = identify(plain, {});
  EXPECT_NEAR(sut.dc_gain_db, in_m_s2.dc_gain_db + 60.0, 1e-6);
  for (std::size_t i = 0; i <= 4; ++i) {
    // A scaled column rounds differently: 1e-16 times the condition number of 1e3.
    EXPECT_NEAR(sut.model.fit.numerator[i], 1e3 * in_m_s2.model.fit.numerator[i], 1e-7);
    EXPECT_NEAR(sut.model.control.numerator[i], 1e3 * in_m_s2.model.control.numerator[i], 1e-4);
  }
  EXPECT_NEAR(std::abs(sut.measured.response[12]), 1e3 * std::abs(in_m_s2.measured.response[12]),
              1e-6);
}

// Of the units, and not of the columns' names.
TEST(IdentifyTest, AMassThatIsNoHandsIsNotUsableUnderAnyName) {
  Measurement other = pegged_body();
  other.channels[0].name = "Acc Y";
  other.channels[1].name = "Grip force";
  for (double& value : other.channels[1].values) value *= 1e3;
  IdentifyOptions options;
  options.input = "Acc Y";
  options.output = "Grip force";
  const IdentifyResult sut = identify(other, options);
  EXPECT_THAT(sut.unusable, HasSubstr("one of the units is wrong"));
  EXPECT_EQ(sut.reason, "unit");
  other.channels[1].unit = "V";
  EXPECT_THAT(result_table(identify(other, options)),
              HasSubstr("units not checked, because only a motion in m/s^2 and a force in N have a "
                        "hand's mass, and these are Acc Y [m/s^2] and Grip force [V]"));
}

// Twenty times the input, both rounded as a logger writes them.
TEST(IdentifyTest, ACopyOfTheInputIsNoResponseToIt) {
  auto input = support::band_noise(30'000, 1000.0, 0.7, 4.0, 1.0, 4);
  auto output = input;
  for (double& value : output) value = std::round(20.0 * value * 1e3) / 1e3;
  for (double& value : input) value = std::round(value * 1e5) / 1e5;
  const IdentifyResult sut = identify(measured(1000.0, input, output), {});
  EXPECT_THAT(sut.unusable, HasSubstr("f is a constant times a_y (20): one sensor twice?"));
  EXPECT_EQ(sut.reason, "copy");
}

// The motion's skirts end before the body's notch of 6.0 Hz, and above 0 Hz.
TEST(IdentifyTest, WhatTheMotionDoesNotExciteIsMarked) {
  const IdentifyResult sut = identify(pegged_body(), {});
  EXPECT_NEAR(sut.excited.low_hz, 0.7, 0.3);
  EXPECT_GT(sut.excited.high_hz, 4.0);
  EXPECT_LT(sut.excited.high_hz, sut.notch->frequency_hz);
  const std::string text = result_table(sut);
  EXPECT_THAT(text, testing::ContainsRegex("excited band +0\\.[0-9]+ to [4-6]\\.?[0-9]* Hz"));
  EXPECT_THAT(text, testing::ContainsRegex("gain at 0 Hz [^\n]*extrapolated by the model"));
  EXPECT_THAT(text, testing::ContainsRegex("notch [^\n]*extrapolated by the model"));
}

TEST(IdentifyTest, WhatIsNotUsableIsSaidFirstAndWithoutTheErrorOfOneStep) {
  IdentifyResult sut = identify(pegged_body(), {});
  EXPECT_THAT(result_table(sut), HasSubstr("one step, unseen"));
  sut.unusable = "swapped";
  sut.model.heldout.free_run_vaf_percent = -1e34;
  const std::string text = result_table(sut);
  EXPECT_THAT(text, testing::StartsWith("usable             no: swapped\n"));
  EXPECT_THAT(text, HasSubstr("VAF below -100 % (worse than the mean)"));
  EXPECT_THAT(text, testing::Not(HasSubstr("one step, unseen")));
}

TEST(IdentifyTest, OfSeveralStretchesTheLongestIsUsed) {
  Measurement sut = pegged_body();
  sut.stretches = {{0, 8000, 0.0}, {8000, 30'000, 20.0}, {30'000, 40'000, 60.0}};
  const IdentifyResult result = identify(sut, {});
  EXPECT_EQ(result.samples, 22'000u);
  EXPECT_THAT(result.notes, Contains("The longest of 3 stretches is used, 22000 samples of 40000 "
                                     "samples."));
}

TEST(IdentifyTest, WhatCannotBeIdentifiedIsRefusedWithItsReason) {
  const auto band = support::band_noise(30'000, 1000.0, 0.7, 4.0, 1.0, 4);
  const auto noise = support::white_noise(3000, 1.0, 4);
  const auto second = support::white_noise(900, 1.0, 4);
  const std::vector<double> constant(3000, 0.7);
  std::vector<double> sine;
  for (int n = 0; n < 6000; ++n) sine.push_back(std::sin(0.1 * n));
  const std::pair<Measurement, const char*> cases[]{
      {measured(1000.0, band, band), "'f' with the values of 'a_y'"},
      {measured(60.0, noise, noise), "pegged.csv: got 60 Hz, want 100 Hz or more"},
      {measured(1000.0, second, second), "900 samples"},
      {measured(100.0, constant, noise), "pegged.csv, channel a_y: got 0.7 m/s^2 throughout"},
      {measured(100.0, noise, constant), "pegged.csv, channel f: got 0.7 N throughout"},
      {measured(100.0, support::white_noise(3000, 0.01, 4), support::white_noise(3000, 1.0, 5)),
       "pegged.csv, a_y to f: got no excitation"},
      {measured(100.0, sine, sine), "independent components"}};
  for (const auto& [measurement, reason] : cases) {
    EXPECT_THAT(error_of(measurement), HasSubstr(reason));
  }
}

TEST(IdentifyTest, AnOutputThatIsNotThereOrIsTheInputIsRefused) {
  IdentifyOptions options;
  options.output = "force";
  EXPECT_THAT(error_of(pegged_body(), options),
              HasSubstr("--output: got 'force', want one of a_y, f in pegged.csv"));
  options.output = "a_y";
  EXPECT_THAT(error_of(pegged_body(), options),
              HasSubstr("--output: got 'a_y', which is the input"));
}

TEST(IdentifyTest, AClockThatIsAThousandthSlowIsTaken) {
  const auto noise = support::white_noise(3000, 1.0, 4);
  const auto other = support::white_noise(3000, 1.0, 5);
  EXPECT_EQ(identify(measured(99.95, noise, other), {}).rate_hz, 99.95);
  EXPECT_THAT(error_of(measured(99.8, noise, other)), HasSubstr("want 100 Hz or more"));
}

TEST(IdentifyTest, AnOffsetLargerThanTheMotionIsPointedOut) {
  Measurement sut = pegged_body();
  EXPECT_TRUE(identify(sut, {}).notes.empty());
  for (double& value : sut.channels[1].values) value += 40.0;
  EXPECT_THAT(identify(sut, {}).notes, Contains(HasSubstr("f has a mean of 40")));
}

TEST(IdentifyTest, TheLargestNumbersAreRefusedOrIdentifiedButNothingElse) {
  for (const double size : {1e150, 1e308}) {
    auto output = support::white_noise(3000, 1.0, 5);
    for (double& value : output) value = std::clamp(value, -1.7, 1.7) * size;
    const std::string error = error_of(measured(100.0, support::white_noise(3000, 1.0, 4), output));
    EXPECT_FALSE(error.empty());
  }
}

// A pole of 16 s: no filter that the canceller would take settles so slowly.
TEST(IdentifyTest, WithoutAFilterForTheCancellerTheFitIsStillGiven) {
  const signal::DifferenceModel slow{100.0, {0.0, 0.01}, {1.0, -0.9994}};
  const auto record = support::record_of(slow, support::white_noise(12'000, 1.0, 6));
  IdentifyOptions options;
  options.config.order = 1;
  const IdentifyResult sut =
      identify(measured(100.0, record.acceleration_m_s2, record.force_n), options);
  EXPECT_THAT(sut.unusable, HasSubstr("filter at 1 kHz for this model: got an error of "));
  EXPECT_TRUE(signal::is_stable(sut.model.fit));
  EXPECT_GT(sut.model.heldout.one_step_vaf_percent, 90.0);
}

// Usable means: the body's own response, g / (1 - r^2 + 2 j d r), r = f / 2.5 Hz.  1 % (0.1 dB) and
// 2 degrees for the chain of 50 Hz and for the rows that are left out.
TEST(IdentifyTest, ASpoiledRecordingGivesTheBodyOrIsNotUsable) {
  for (const spoiled::Case& each : spoiled::cases()) {
    recording::Recording rows = spoiled::recorded(each);
    auto faults = measurement::screen(rows, {});
    Measurement measurement = measurement::on_grid(std::move(rows), 1'000'000);
    measurement.screening = std::move(faults);
    const IdentifyResult sut = identify(measurement, {});
    EXPECT_EQ(sut.unusable.empty(), !each.no_model) << each.name << ": " << sut.unusable;
    // The limit of a clipped channel stays, and bends the response: it is said, not mended.
    if (each.no_model || each.what == "clipped") continue;
    for (const double hz : {0.7, 2.5, 4.0}) {
      const double r = hz / spoiled::kResonance_hz;
      const std::complex<double> truth =
          spoiled::kGain_n_s2_m / std::complex<double>(1.0 - r * r, 2.0 * spoiled::kDamping * r);
      const auto found = identification::frequency_response(sut.model.fit, {hz}).front();
      EXPECT_NEAR(found.magnitude_db, 20.0 * std::log10(std::abs(truth)), 0.1) << each.name;
      EXPECT_NEAR(found.phase_deg, std::arg(truth) * 180.0 / std::numbers::pi, 2.0) << each.name;
    }
  }
}

// A part of the recording has another gain or level than the rest, or a limit lies behind a noise:
// linear models explain up to 99.9 % of the last quarter, and are off by 5 % and more.
TEST(IdentifyTest, WhatChangesWithinARecordingIsNamedAndNotUsable) {
  struct Change {
    std::string words;
    void (*make)(spoiled::Values& a, spoiled::Values& f);
  };
  const auto part = [](spoiled::Values& x, std::size_t first, std::size_t end, double by,
                       double shift) {
    for (std::size_t n = first; n < end; ++n) x[n] = by * x[n] + shift;
  };
  static const auto change = part;
  const std::vector<Change> changes{
      {"times the gain from 30.06 to 60 s",
       [](auto&, auto& f) { change(f, 3000, 6000, 3.0, 0.0); }},
      {"times the gain from 20.06 to 60 s",
       [](auto&, auto& f) { change(f, 2000, 6000, 1.2, 0.0); }},
      {"times the gain from 20.06 to 30.06 s",
       [](auto&, auto& f) { change(f, 2000, 3000, 3.0, 0.0); }},
      {"the mean of f is 20 N higher from 30",
       [](auto&, auto& f) { change(f, 3000, 6000, 1.0, 20.0); }},
      {"the mean of f is 4.99 N higher from 10",
       [](auto&, auto& f) { change(f, 1000, 2000, 1.0, 5.0); }},
      {"the mean of a_y is", [](auto& a, auto&) { change(a, 3000, 6000, 1.0, 5.0); }},
      {"f follows a_y up to", [](auto&, auto& f) {
         for (double& value : f) value = std::clamp(value, -2.0, 2.5);
         spoiled::add_noise(f, 0.1);
       }}};
  for (const Change& each : changes) {
    recording::Recording rows = spoiled::known_body();
    each.make(rows.columns[0].values, rows.columns[1].values);
    const IdentifyResult sut = identify(measurement::on_grid(std::move(rows), 1'000'000), {});
    // 0.06 s later: the chain's filters delay the record by that.
    EXPECT_THAT(std::string(sut.unusable), HasSubstr(each.words));
  }
}

}  // namespace
}  // namespace stillhand::identify::identify_test
