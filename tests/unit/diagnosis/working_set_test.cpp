// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/working_set.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/core/contract/config_error.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::working_set_test {

using testing::HasSubstr;
using testing::SizeIs;

std::vector<double> sine(std::size_t count, double rate_hz, double frequency_hz,
                         double phase_rad = 0.3) {
  std::vector<double> x(count);
  for (std::size_t n = 0; n < count; ++n) {
    x[n] = std::sin(2.0 * std::numbers::pi * frequency_hz * static_cast<double>(n) / rate_hz +
                    phase_rad);
  }
  return x;
}

Measurement at_1_khz() {
  const auto y = made::sum_of(sine(10000, 1000.0, 3.0, 1.1), sine(10000, 1000.0, 60.0));
  return made::measurement_of({{"u", "V", sine(10000, 1000.0, 1.0)}, {"y", "N", y}}, 1000.0);
}

TEST(WorkingSetTest, ASlowInputIsWorkedOnAt100Hz) {
  const Measurement sut = working_set(at_1_khz(), {"u"});
  EXPECT_DOUBLE_EQ(sut.rate_hz, 100.0);
  EXPECT_EQ(sut.size(), 1000u);
  EXPECT_NO_THROW(check(sut));
  ASSERT_THAT(sut.notes, SizeIs(1));
  EXPECT_THAT(sut.notes[0], HasSubstr("100"));
}

// Butterworth of order 8 at 40 Hz, twice: 1 Hz passes but for (1/40)^16, in phase.  At the ends its
// answer to the record's start and end, 4 s of 20 Hz bandwidth later nothing.  60 Hz would fold to
// 40 Hz.  (tan(60 pi/1000)/tan(40 pi/1000))^16 = 733: amplitude 1/734.
TEST(WorkingSetTest, ASlowSineKeepsItsAmplitudeAndPhaseAndWhatWouldFoldIsTakenOut) {
  const Measurement sut = working_set(at_1_khz(), {"u"});
  const auto input = sine(1000, 100.0, 1.0);
  const auto output = sine(1000, 100.0, 3.0, 1.1);
  double largest = 0.0;
  for (std::size_t n = 100; n < 900; ++n) {
    ASSERT_NEAR(sut.channels[0].values[n], input[n], 1e-9) << n;
    largest = std::max(largest, std::abs(sut.channels[1].values[n] - output[n]));
  }
  EXPECT_LT(largest, 1.01 / 734.0);
  EXPECT_GT(largest, 0.9 / 734.0);
}

TEST(WorkingSetTest, TheRateStaysTwentyTimesAboveTheInput) {
  const auto rate_for = [](double frequency_hz) {
    const Measurement measurement = made::measurement_of(
        {{"u", "V", sine(20000, 1000.0, frequency_hz)}, {"y", "N", made::white(20000, 1)}}, 1000.0);
    return working_set(measurement, {"u"}).rate_hz;
  };
  EXPECT_DOUBLE_EQ(rate_for(2.0), 100.0);
  // 20 x 14 Hz and a line of the spectrum, 0.24 Hz: 285 to 300 Hz wanted, 1000/3.
  EXPECT_NEAR(rate_for(14.0), 1000.0 / 3.0, 1e-9);
  EXPECT_DOUBLE_EQ(rate_for(40.0), 1000.0);
}

TEST(WorkingSetTest, AMeasurementThatFitsIsLeftAsItIs) {
  const Measurement measurement =
      made::measurement_of({{"u", "V", made::ride(3000, 1)}, {"y", "N", made::white(3000, 2)}});
  const Measurement sut = working_set(measurement, {"u"});
  EXPECT_EQ(sut.channels[1].values, measurement.channels[1].values);
  EXPECT_THAT(sut.notes, SizeIs(0));
}

TEST(WorkingSetTest, AFilledSampleMakesItsGroupCountNothing) {
  Measurement measurement = at_1_khz();
  measurement.weight[4321] = 0.0;
  const Measurement sut = working_set(measurement, {"u"});
  for (std::size_t n = 0; n < sut.size(); ++n) EXPECT_EQ(sut.weight[n], n == 432 ? 0.0 : 1.0) << n;
}

TEST(WorkingSetTest, AModelsRateIsAWholeFractionThatAnIntegerCounts) {
  const Measurement measurement = at_1_khz();
  EXPECT_EQ(rate_factor(measurement, 1000.0), 1u);
  EXPECT_EQ(rate_factor(measurement, 100.0), 10u);
  EXPECT_EQ(rate_factor(measurement, 1e-3), 1'000'000u);
  // 1e-17 Hz: 1e20 samples; the quotient of the last is infinite.
  for (const double rate_hz : {1500.0, 300.0, 1e-17, 1e-310, std::nan("")}) {
    EXPECT_THROW(static_cast<void>(rate_factor(measurement, rate_hz)), ConfigError) << rate_hz;
  }
}

// A stretch keeps its start, and its samples lie where they lay; it never grows over the gap behind
// it, which here is 6 ms, less than a sample of the new rate.
TEST(WorkingSetTest, StretchesKeepTheirTimes) {
  Measurement measurement = at_1_khz();
  measurement.stretches = {{0, 4001, 2.0}, {4001, 10000, 2.0 + 4.007}};
  const Measurement sut = working_set(measurement, {"u"});
  EXPECT_NO_THROW(check(sut));
  ASSERT_THAT(sut.stretches, SizeIs(2));
  EXPECT_EQ(sut.stretches[0].end, 400u);
  EXPECT_DOUBLE_EQ(sut.stretches[0].start_s, 2.0);
  EXPECT_EQ(sut.size(), 999u);
  EXPECT_DOUBLE_EQ(sut.stretches[1].start_s, 6.007);
  // Sample 100 of the second: 4001 + 1000 of the original.
  EXPECT_NEAR(sut.channels[0].values[500], measurement.channels[0].values[5001], 1e-9);
}

Measurement long_one(std::size_t count) {
  std::vector<double> number(count);
  for (std::size_t n = 0; n < count; ++n) number[n] = static_cast<double>(n);
  return made::measurement_of({{"u", "V", made::ride(count, 1)}, {"y", "N", number}});
}

TEST(WorkingSetTest, ALongRecordIsThinnedToPiecesSpreadOverIt) {
  EXPECT_EQ(working_set(long_one(kMostSamples), {"u"}).size(), kMostSamples);
  for (const std::size_t count : {kMostSamples + 1, std::size_t{200'000}}) {
    const std::size_t size = working_set(long_one(count), {"u"}).size();
    EXPECT_TRUE(size <= kMostSamples && size > kMostSamples * 9 / 10) << size;
  }
  const Measurement sut = working_set(long_one(200'000), {"u"});
  EXPECT_NO_THROW(check(sut));
  EXPECT_THAT(sut.stretches, SizeIs(40));
  // The first begins at the start, the last in the last fortieth.
  EXPECT_EQ(sut.channels[1].values.front(), 0.0);
  EXPECT_GE(sut.channels[1].values.back(), 0.975 * 200'000);
  // Every sample kept has its own time.
  const auto time_s = sut.time_s();
  for (std::size_t n = 0; n < sut.size(); n += 997) {
    EXPECT_NEAR(time_s[n], sut.channels[1].values[n] / made::kRateHz, 1e-9);
  }
  EXPECT_THAT(sut.notes, SizeIs(1));
}

// Four pieces of 100 in steps of 250; a seam cuts them, and less than 50 are no piece.
TEST(WorkingSetTest, PiecesBeginAtWholeStepsAndEndWithTheirStretch) {
  const auto sut = [](std::size_t seam) {
    std::string text;
    for (const Stretch& each :
         spread_pieces({{0, seam, 5.0}, {seam, 1000, 20.0, 1}}, 4, 400, made::kRateHz)) {
      text += fmt::format("{}-{} {:g} s {}, ", each.first, each.end, each.start_s, each.recording);
    }
    return text;
  };
  EXPECT_EQ(sut(550),
            "0-100 5 s 0, 250-350 7.5 s 0, 500-550 10 s 0, 550-600 20 s 1, 750-850 22 s 1, ");
  EXPECT_EQ(sut(549), "0-100 5 s 0, 250-350 7.5 s 0, 549-600 20 s 1, 750-850 22.01 s 1, ");
}

TEST(WorkingSetTest, ManyStretchesAreThinnedToTheSameSize) {
  for (const std::size_t length : {400u, 2000u, 7919u}) {
    SCOPED_TRACE(length);
    Measurement measurement = long_one(400'000);
    measurement.stretches.clear();
    for (std::size_t n = 0; n < 400'000; n += length) {
      measurement.stretches.push_back({n, std::min<std::size_t>(n + length, 400'000),
                                       2.0 * static_cast<double>(n) / made::kRateHz});
    }
    const Measurement sut = working_set(measurement, {"u"});
    EXPECT_NO_THROW(check(sut));
    EXPECT_LE(sut.size(), kMostSamples);
    // Pieces of 2000 are cut by at most three ends; parts below 50 are dropped.
    EXPECT_GT(sut.size(), kMostSamples * 9 / 10);
  }
}

// Refused later, by name; here nothing may go wrong.
TEST(WorkingSetTest, InputsWithoutABandAreNoReasonToFail) {
  Measurement measurement = at_1_khz();
  EXPECT_DOUBLE_EQ(working_set(measurement, {"not there"}).rate_hz, 100.0);
  std::ranges::fill(measurement.channels[0].values, 0.0);
  EXPECT_DOUBLE_EQ(working_set(measurement, {"u"}).rate_hz, 100.0);
}

}  // namespace stillhand::diagnosis::working_set_test
