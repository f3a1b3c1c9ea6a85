// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/grid.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "services/core/contract/config_error.hpp"
#include "services/core/signal/random.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::measurement::grid_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::size_t kPlenty = 1'000'000;

double slow_wave(double t) { return std::sin(2.0 * t) + 0.3 * std::cos(5.0 * t); }

recording::Recording rows_at(const std::vector<double>& time_s) {
  recording::Recording rows;
  rows.source = "ride.csv";
  rows.time_s = time_s;
  rows.columns = {{"a_y", "m/s^2", {}}, {"f", "N", {}}};
  for (const double t : time_s) {
    rows.columns[0].values.push_back(slow_wave(t));
    rows.columns[1].values.push_back(-3.0 * slow_wave(t));
  }
  estimate_timing(rows);
  return rows;
}

// Rows at 100 Hz whose number passes.
std::vector<double> times(int count, const std::function<bool(int)>& present) {
  std::vector<double> time_s;
  for (int i = 0; i < count; ++i) {
    if (present(i)) time_s.push_back(i * 0.01);
  }
  return time_s;
}

std::string error_of(const recording::Recording& rows, std::size_t most_values = kPlenty) {
  return support::refusal([&] { (void)on_grid(rows, most_values); });
}

TEST(GridTest, AnEvenRecordingIsTakenAsItIs) {
  const auto rows = rows_at(times(200, [](int) { return true; }));
  const auto sut = on_grid(rows, kPlenty);
  check(sut);
  EXPECT_EQ(sut.source, "ride.csv");
  EXPECT_EQ(sut.rate_hz, 100.0);
  ASSERT_EQ(sut.channels.size(), 2u);
  EXPECT_EQ(sut.channels[1].name, "f");
  EXPECT_EQ(sut.channels[1].unit, "N");
  EXPECT_EQ(sut.channels[1].values, rows.columns[1].values);
  EXPECT_EQ(sut.stretches.size(), 1u);
  EXPECT_THAT(sut.weight, testing::Each(1.0));
  EXPECT_THAT(sut.notes, IsEmpty());
}

TEST(GridTest, AShortGapIsFilledInAndWeighsNothing) {
  const auto sut = on_grid(rows_at(times(300, [](int i) { return i < 100 || i > 104; })), kPlenty);
  check(sut);
  ASSERT_EQ(sut.size(), 300u);
  EXPECT_EQ(sut.stretches.size(), 1u);
  for (std::size_t n = 0; n < 300; ++n) {
    EXPECT_EQ(sut.weight[n], n >= 100 && n <= 104 ? 0.0 : 1.0) << n;
    // Of 5 rad/s: (0.05 rad * 6)^4 * 0.15 / 24 = 5e-5.
    EXPECT_NEAR(sut.channels[0].values[n], slow_wave(static_cast<double>(n) * 0.01), 1e-4) << n;
  }
  EXPECT_THAT(sut.notes, ElementsAre(HasSubstr("5 rows missing in gaps of at most 50 ms")));
}

TEST(GridTest, ALongGapBeginsANewStretch) {
  const auto sut = on_grid(rows_at(times(600, [](int i) { return i < 200 || i >= 320; })), kPlenty);
  check(sut);
  ASSERT_EQ(sut.stretches.size(), 2u);
  EXPECT_EQ(sut.stretches[1].first, 200u);
  EXPECT_EQ(sut.stretches[1].end, 480u);
  EXPECT_NEAR(sut.stretches[1].start_s, 3.2, 1e-12);
  EXPECT_NEAR(sut.channels[0].values[200], slow_wave(3.2), 1e-12);
  EXPECT_THAT(sut.notes, ElementsAre(HasSubstr("120 rows missing in 1 gap longer than 50 ms")));
}

TEST(GridTest, AStretchOfLessThanASecondIsLeftOut) {
  const auto sut = on_grid(
      rows_at(times(1000, [](int i) { return i < 300 || (i >= 400 && i < 450) || i >= 600; })),
      kPlenty);
  check(sut);
  ASSERT_EQ(sut.stretches.size(), 2u);
  EXPECT_EQ(sut.size(), 700u);
  EXPECT_NEAR(sut.stretches[1].start_s, 6.0, 1e-12);
  EXPECT_NEAR(sut.channels[0].values[300], slow_wave(6.0), 1e-12);
  EXPECT_THAT(sut.notes, Contains(HasSubstr("50 rows left out, in stretches shorter than 1 s")));
}

// 5 kHz for half a second: nothing longer to prefer.
TEST(GridTest, AShortRecordingOfAFastSensorIsKept) {
  std::vector<double> time_s;
  for (int i = 0; i < 2500; ++i) time_s.push_back(i * 0.0002);
  EXPECT_EQ(on_grid(rows_at(time_s), kPlenty).size(), 2500u);
}

// A sampled sine of 5 rad/s at 100 Hz between four rows: (0.05 * 1.2)^4 / 24 < 1e-6 of it.
TEST(GridTest, JitteredRowsAreResampledAtTheirTrueTimes) {
  signal::Gaussian random(11, 0);
  std::vector<double> time_s;
  for (int i = 0; i < 2000; ++i) time_s.push_back(0.01 * (i + 0.3 * (random.uniform() - 0.5)));
  const auto sut = on_grid(rows_at(time_s), kPlenty);
  check(sut);
  EXPECT_EQ(sut.rate_hz, 100.0);
  const auto at_s = sut.time_s();
  for (std::size_t n = 2; n + 3 < sut.size(); ++n) {
    ASSERT_NEAR(sut.channels[1].values[n], -3.0 * slow_wave(at_s[n]), 1e-5) << n;
  }
  EXPECT_THAT(sut.notes, ElementsAre(HasSubstr("resampled to 100 Hz")));
}

TEST(GridTest, TooFewRowsAreRefusedWithTheirNumber) {
  EXPECT_THAT(error_of(rows_at(times(10, [](int) { return true; }))),
              HasSubstr("ride.csv: got 0 usable samples in 10 rows at 100 Hz, want at least 50"));
  EXPECT_THAT(error_of(rows_at(times(49, [](int) { return true; }))),
              HasSubstr("49 usable samples in 49 rows"));
  EXPECT_EQ(error_of(rows_at(times(50, [](int) { return true; }))), "accepted");
}

TEST(GridTest, BelowFiveRowsASecondANoteSaysSo) {
  const auto at_rate = [](double rate_hz) {
    std::vector<double> time_s;
    for (int i = 0; i < 200; ++i) time_s.push_back(i / rate_hz);
    return rows_at(time_s);
  };
  EXPECT_THAT(on_grid(at_rate(5.0), kPlenty).notes, ElementsAre());
  const diagnosis::Measurement sut = on_grid(at_rate(0.1), kPlenty);
  EXPECT_EQ(sut.rate_hz, 0.1);
  EXPECT_EQ(sut.size(), 200u);
  EXPECT_THAT(sut.notes, ElementsAre("10 s between rows: no motion of a hand shows."));
}

TEST(GridTest, ManyStretchesTooShortToUseAreRefused) {
  EXPECT_THAT(error_of(rows_at(times(3000, [](int i) { return i % 30 < 15; }))),
              HasSubstr("0 usable samples in 1500 rows"));
}

TEST(GridTest, MoreMissingThanThereIsIsRefused) {
  // Pairs of rows, then three missing: the steps' median is still one period.
  EXPECT_THAT(error_of(rows_at(times(3000, [](int i) { return i % 6 < 3 || i % 600 > 590; }))),
              HasSubstr("accepted"));
  EXPECT_THAT(error_of(rows_at(times(3000, [](int i) { return i % 8 < 3 || i % 600 > 560; }))),
              HasSubstr("more rows missing than there are"));
}

TEST(GridTest, MoreThanAskedForIsRefused) {
  const auto rows = rows_at(times(200, [](int) { return true; }));
  EXPECT_EQ(error_of(rows, 400), "accepted");
  EXPECT_THAT(error_of(rows, 399), HasSubstr("200 samples of 2 channels, want at most 399 values"));
}

}  // namespace stillhand::measurement::grid_test
