// SPDX-License-Identifier: Apache-2.0
#include "apps/measurement/sample_screen.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/spoiled_recordings.hpp"

namespace stillhand::measurement {
namespace {

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

TEST(SampleScreenTest, EveryFaultIsNamedWithItsChannelAndNoOther) {
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
  }
}

// Rows that are left out are those of the fault: nothing beyond the signals' own range is left.
TEST(SampleScreenTest, WhatIsLeftLiesInTheRangeOfTheGoodRecording) {
  const Recording good = spoiled::known_body();
  for (const spoiled::Case& each : spoiled::cases()) {
    if (each.no_model) continue;
    Recording rows = spoiled::recorded(each);
    (void)screen(rows, {});
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
  EXPECT_THAT(sut[0].says, HasSubstr("left out"));
}

TEST(SampleScreenTest, AChannelOutsideOfTheModelIsLeftOutWhole) {
  Recording rows = spoiled::known_body();
  rows.columns.push_back({"grip", "N", rows.columns[1].values});
  spoiled::fill(rows.columns[2].values, 2000, 4000, 1.25);
  rows.columns.push_back({"count", "-", {}});
  for (std::size_t n = 0; n < spoiled::kRows; ++n) {
    rows.columns[3].values.push_back(static_cast<double>(n));
  }
  const auto sut = screen(rows, {});
  ASSERT_EQ(sut.size(), 2u);
  EXPECT_EQ(sut[0].what, "stuck");
  EXPECT_EQ(sut[1].what, "counter");
  EXPECT_EQ(rows.columns.size(), 2u);
  EXPECT_EQ(rows.row_count(), spoiled::kRows);
}

TEST(SampleScreenTest, AFaultOfMostRowsMakesTheChannelUnsound) {
  Recording rows = spoiled::known_body();
  spoiled::fill(rows.columns[1].values, 2000, 5500, 1.25);
  const auto sut = screen(rows, {});
  ASSERT_EQ(sut.size(), 1u);
  EXPECT_TRUE(sut[0].unsound);
  EXPECT_EQ(rows.row_count(), spoiled::kRows);
}

// What good recordings hold: a command that rests at levels, few digits, a slow temperature, a
// switch, and a rest before the motion.
TEST(SampleScreenTest, GoodChannelsHaveNoFault) {
  Recording rows = spoiled::known_body();
  auto& a = rows.columns[0].values;
  spoiled::fill(a, 0, 300, 0.0);
  for (double& value : rows.columns[1].values) value = std::round(value * 50.0) / 50.0;
  recording::Column temperature{"temp", "degC", {}};
  recording::Column button{"button", "-", {}};
  recording::Column target{"x_r", "m", {}};
  for (std::size_t n = 0; n < spoiled::kRows; ++n) {
    const double t_s = static_cast<double>(n) / spoiled::kRate_hz;
    temperature.values.push_back(std::round(200.0 + 20.0 * std::sin(0.1 * t_s)) / 10.0);
    button.values.push_back(n % 2000 < 5 ? 1.0 : 0.0);
    target.values.push_back(n / 1000 % 2 == 0 ? 0.1 : 0.2 * std::sin(t_s));
  }
  rows.columns.push_back(temperature);
  rows.columns.push_back(button);
  rows.columns.push_back(target);
  const auto sut = screen(rows, {});
  EXPECT_THAT(sut, IsEmpty()) << sut[0].says;
  EXPECT_EQ(rows.columns.size(), 5u);
}

}  // namespace
}  // namespace stillhand::measurement
