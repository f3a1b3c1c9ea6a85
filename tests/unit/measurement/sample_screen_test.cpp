// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/sample_screen.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/spoiled_recordings.hpp"

namespace stillhand::measurement::sample_screen_test {

using diagnosis::SampleFault;
using recording::Recording;
using testing::HasSubstr;
using testing::IsEmpty;

const SampleFault* find(const std::vector<SampleFault>& faults, const spoiled::Case& each) {
  const auto at = std::ranges::find_if(faults, [&](const SampleFault& fault) {
    return fault.channel == each.channel && fault.what == each.what;
  });
  return at == faults.end() ? nullptr : &*at;
}

// Rows that are left out are those of the fault: nothing beyond the signals' own range is left.
TEST(SampleScreenTest, EveryFaultIsNamedWithItsChannelAndNoOtherAndTakenOut) {
  const Recording good = spoiled::known_body();
  for (const spoiled::Case& each : spoiled::cases()) {
    Recording rows = spoiled::recorded(each);
    const std::vector<SampleFault> sut = screen(rows, {});
    if (each.what.empty()) {
      EXPECT_THAT(sut, IsEmpty()) << each.name << ": " << (sut.empty() ? "" : sut[0].says);
      EXPECT_EQ(rows.row_count(), spoiled::kRows) << each.name;
      continue;
    }
    const SampleFault* found = find(sut, each);
    ASSERT_NE(found, nullptr) << each.name;
    EXPECT_EQ(found->unsound, each.no_model) << each.name;
    for (const SampleFault& fault : sut) EXPECT_EQ(fault.what, each.what) << each.name;
    if (each.no_model) continue;
    EXPECT_GT(rows.row_count(), spoiled::kRows / 2) << each.name;
    for (std::size_t c = 0; c < 2; ++c) {
      const auto [low, high] = std::ranges::minmax(good.columns[c].values);
      const auto [least, most] = std::ranges::minmax(rows.columns[c].values);
      EXPECT_GE(least, low) << each.name;
      EXPECT_LE(most, high) << each.name;
    }
  }
}

TEST(SampleScreenTest, TheShareAndTheTimeAreThoseOfTheFault) {
  Recording rows = spoiled::known_body();
  spoiled::fill(rows.columns[1].values, 3000, 3030, 32767.0);
  const auto sut = screen(rows, {});
  ASSERT_EQ(sut.size(), 1u);
  EXPECT_DOUBLE_EQ(sut[0].share, 30.0 / 6000.0);
  EXPECT_EQ(sut[0].times_s, std::vector{30.0});
  EXPECT_EQ(rows.row_count(), spoiled::kRows - 30);
  EXPECT_EQ(
      sut[0].says,
      "f: rail at 32767, 0.5 % of the rows in 1 place, from 30 s on; these rows are left out.");
  spoiled::scatter(rows.columns[0].values, 30, -9999.0, false);
  EXPECT_EQ(screen(rows, {}).at(0).times_s.size(), 10u);
}

TEST(SampleScreenTest, AChannelOutsideOfTheModelIsLeftOutWhole) {
  Recording rows = spoiled::known_body();
  rows.columns.push_back({"grip", "N", rows.columns[1].values});
  spoiled::Dice dice;
  for (double& value : rows.columns[2].values) value += 0.1 * dice.next();
  spoiled::fill(rows.columns[2].values, 2000, 4000, 0.0);
  rows.columns.push_back({"count", "-", {}});
  for (std::size_t n = 0; n < spoiled::kRows; ++n) {
    rows.columns[3].values.push_back(static_cast<double>(n));
  }
  rows.columns.push_back({"a_x", "m/s^2", rows.columns[0].values});
  spoiled::hold(rows.columns[4].values, 5.0);
  const auto sut = screen(rows, {});
  ASSERT_EQ(sut.size(), 3u);
  EXPECT_EQ(sut[0].what, "stuck");
  EXPECT_EQ(sut[1].what, "counter");
  EXPECT_EQ(sut[2].says,
            "a_x: each value is held for 5 rows: 20 Hz inside 100 Hz, late by 20 ms on the mean; "
            "record it at its own rate; the channel is left out.");
  EXPECT_FALSE(sut[2].unsound);
  EXPECT_EQ(rows.columns.size(), 2u);
  EXPECT_EQ(rows.row_count(), spoiled::kRows);
}

TEST(SampleScreenTest, AFaultOfMostRowsMakesTheChannelUnsound) {
  for (const std::size_t end : {5000u, 5001u}) {
    Recording rows = spoiled::known_body();
    spoiled::fill(rows.columns[1].values, 2000, end, 1.25);
    const auto sut = screen(rows, {});
    ASSERT_EQ(sut.size(), 1u);
    EXPECT_EQ(sut[0].unsound, end == 5001);
    EXPECT_EQ(rows.row_count(), end == 5001 ? 6000u : 3000u);
  }
}

TEST(SampleScreenTest, FaultsThatTogetherAreMostRowsAreAllUnsound) {
  for (const std::size_t end : {3000u, 3001u}) {
    Recording rows = spoiled::known_body();
    spoiled::fill(rows.columns[0].values, 0, 1500, -9999.0);
    spoiled::fill(rows.columns[1].values, 1500, end, 999.0);
    const auto sut = screen(rows, {});
    ASSERT_EQ(sut.size(), 2u);
    for (const SampleFault& fault : sut) EXPECT_EQ(fault.unsound, end == 3001);
    EXPECT_EQ(rows.row_count(), end == 3001 ? 6000u : 3000u);
  }
}

// 1 - sinc(f/r)^2 at 4 Hz: of lines between samples of 50 Hz 2.1 %, which a model bears.
TEST(SampleScreenTest, LinesThatLoseLittleAreNoted) {
  Recording rows = spoiled::known_body();
  spoiled::draw_lines(rows.columns[1].values, 2);
  const SampleFault sut = screen(rows, {}).at(0);
  EXPECT_THAT(sut.says, HasSubstr(" inside 100 Hz, which lose 2.1 % at 4 Hz; "));
  EXPECT_FALSE(sut.unsound);
}

template <typename ValueAt>
recording::Column channel(std::string name, std::string unit, ValueAt value_at) {
  recording::Column out{std::move(name), std::move(unit), {}};
  for (std::size_t n = 0; n < spoiled::kRows; ++n) {
    out.values.push_back(value_at(n, static_cast<double>(n) / spoiled::kRate_hz));
  }
  return out;
}

// What good recordings hold; every kind is screened next to the known body.
TEST(SampleScreenTest, GoodChannelsHaveNoFault) {
  spoiled::Dice dice;
  const auto noise = [&dice] { return dice.next() - 0.5; };
  spoiled::Dice flips;
  double omega = 0.0;
  bool count = false;
  const double quantum_rad = 2.0 * std::numbers::pi / 4096.0;
  // A pegged stick: its encoder flips by one count now and then.
  const auto pegged_rate = [&](std::size_t, double) {
    double step = 0.0;
    if (flips.next() < 0.01) {
      step = (count ? -1.0 : 1.0) * quantum_rad * spoiled::kRate_hz;
      count = !count;
    }
    return omega += 0.6 * (step - omega);
  };
  const std::vector<recording::Column> channels{
      channel("omega", "rad/s", pegged_rate),
      // A hand that slows down, rests for 25 s and moves on; 4096 counts.
      channel("theta", "rad",
              [&](std::size_t, double t_s) {
                const double fade = 0.3;
                const double moved_s = t_s < 20.0 ? t_s
                                       : t_s < 45.0
                                           ? 20.0 + fade * (1.0 - std::exp(-(t_s - 20.0) / fade))
                                           : t_s - 25.0 + fade * std::exp(-(t_s - 45.0) / fade);
                const double angle_rad = 0.2 * std::sin(4.0 * moved_s);
                return std::round(angle_rad / quantum_rad) * quantum_rad;
              }),
      channel("temp", "degC",
              [](std::size_t, double t_s) {
                return std::round(200.0 + 20.0 * std::sin(0.1 * t_s)) / 10.0;
              }),
      channel("button", "-", [](std::size_t n, double) { return n % 2000 < 5 ? 1.0 : 0.0; }),
      channel(
          "x_r", "m",
          [](std::size_t n, double t_s) { return n / 1000 % 2 == 0 ? 0.1 : 0.2 * std::sin(t_s); }),
      // Ramps at one speed from level to level, and rests there.
      channel("x_p", "m",
              [at = 0.0](std::size_t n, double) mutable {
                if (n % 300 < 37) at += n / 300 % 3 == 0 ? -0.02 : 0.011;
                return at;
              }),
      // New levels at even times: a command, in volts.
      channel("u", "V",
              [&noise, at = 0.0](std::size_t n, double) mutable {
                return at = n % 20 == 0 ? noise() : at;
              }),
      // Bursts of noise, and silence.
      channel("drive", "V",
              [&noise](std::size_t n, double) { return n / 500 % 2 == 0 ? noise() : 0.0; }),
      // Footfalls of three rows, not all equally strong, once a second, over a little noise.
      channel("belt", "N",
              [&noise](std::size_t n, double) {
                const double shape[] = {0.6, 1.0, 0.5};
                const std::size_t at = n % 97;
                return 0.1 * noise() + (at < 3 ? (40.0 + 10.0 * noise()) * shape[at] : 0.0);
              }),
      // The same, so short that each is one row.
      channel("heel", "N",
              [&noise](std::size_t n, double) {
                return 0.1 * noise() + (n % 97 == 5 ? 40.0 + 10.0 * noise() : 0.0);
              }),
      // Grip: none for seconds, then up to 20 N within 0.1 s.
      channel("grip", "N",
              [](std::size_t n, double) {
                const double at = static_cast<double>(n % 1500) / 1500.0;
                return at < 0.5 ? 0.0
                                : 20.0 *
                                      std::sin(std::numbers::pi * std::min(1.0, 20.0 * (at - 0.5)) /
                                               2.0) *
                                      (1.0 - at) * 2.0;
              }),
      // A hum of a quarter of the rate, and one that is no part of it, on a motion.
      channel("hum", "N",
              [&noise](std::size_t n, double t_s) {
                return std::sin(4.0 * t_s) + 0.02 * noise() +
                       0.3 * std::sin(0.5 * std::numbers::pi * static_cast<double>(n) + 0.7);
              }),
      channel("motor", "N",
              [&noise](std::size_t n, double t_s) {
                return std::sin(4.0 * t_s) + 0.02 * noise() +
                       0.3 * std::sin(0.5878 * std::numbers::pi * static_cast<double>(n));
              }),
      channel("small", "m/s^2", [&noise](std::size_t, double) { return 1e-9 * noise(); })};
  for (const recording::Column& channel : channels) {
    Recording rows = spoiled::known_body();
    rows.columns.push_back(channel);
    const auto sut = screen(rows, {});
    EXPECT_THAT(sut, IsEmpty()) << channel.name << ": " << (sut.empty() ? "" : sut[0].says);
    EXPECT_EQ(rows.columns.size(), 3u) << channel.name;
  }
}

// As the input and as the output, with the other one as it is.
TEST(SampleScreenTest, AChannelThatIsTappedHasNoFault) {
  for (const std::size_t channel : {0u, 1u}) {
    Recording rows = spoiled::known_body();
    for (const std::size_t row : {611u, 2222u, 4000u, 4800u, 5500u, 5801u}) {
      for (std::size_t k = 0; k < 4; ++k) {
        rows.columns[channel].values[row + k] += 40.0 * std::sin(0.7 * static_cast<double>(k + 1));
      }
    }
    const auto sut = screen(rows, {});
    EXPECT_THAT(sut, IsEmpty()) << channel << (sut.empty() ? "" : sut[0].says);
  }
}

}  // namespace stillhand::measurement::sample_screen_test
