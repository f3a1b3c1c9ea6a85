// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/verdict/control_laws.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "services/core/cancellation/value_table.hpp"

namespace stillhand::close_the_loop::control_laws_test {
namespace {

using cancellation::Channel;

TEST(ControlLawsTest, EveryChannelIsFoundByItsName) {
  for (std::size_t i = 0; i < cancellation::kChannels; ++i) {
    const auto sut = channel_of(cancellation::kChannelFacts[i].name);
    ASSERT_TRUE(sut) << cancellation::kChannelFacts[i].name;
    EXPECT_EQ(static_cast<std::size_t>(*sut), i);
  }
}

TEST(ControlLawsTest, OtherNamesAreNoChannels) {
  for (const char* name : {"", "A_Y", "a_y ", "a_", "rate of theta", "temp"}) {
    EXPECT_FALSE(channel_of(name)) << name;
  }
}

TEST(ControlLawsTest, ATableHoldsTheMapAtEvenDistancesAndBothEnds) {
  const auto sut = table(-2.0, 6.0, [](double x) { return x * x; });
  EXPECT_EQ(sut.low, -2.0);
  EXPECT_EQ(sut.high, 6.0);
  ASSERT_GT(sut.values.size(), 2u);
  EXPECT_EQ(sut.values.front(), 4.0);
  EXPECT_EQ(sut.values.back(), 36.0);
  const double step = 8.0 / static_cast<double>(sut.values.size() - 1);
  for (std::size_t i = 0; i < sut.values.size(); ++i) {
    const double x = -2.0 + static_cast<double>(i) * step;
    EXPECT_NEAR(sut.values[i], x * x, 1e-13) << i;
  }
}

// A symmetric map's table has a value at 0: a sign must not be smeared to one side.
TEST(ControlLawsTest, ATableAboutZeroHasAValueThere) {
  const auto sut = table(-3.0, 3.0, [](double x) { return std::tanh(5.0 * x); });
  ASSERT_EQ(sut.values.size() % 2, 1u);
  EXPECT_EQ(sut.values[sut.values.size() / 2], 0.0);
  for (std::size_t i = 0; i < sut.values.size(); ++i) {
    EXPECT_NEAR(sut.values[i], -sut.values[sut.values.size() - 1 - i], 1e-15) << i;
  }
}

// A dead zone whose bends lie between a plain table's values: over the whole range 2 x 3 in 128
// cells of 0.047 a bend is missed by up to a quarter of a cell, 0.012.
TEST(ControlLawsTest, TheNearestTableLaysItsValuesOnTheBends) {
  const auto dead = [](double x) { return x - std::clamp(x, -0.77, 0.77); };
  const auto miss = [&](const cancellation::ValueMap& map) {
    const cancellation::ValueTable sut(map);
    double most = 0.0;
    for (double x = -3.0; x <= 3.0; x += 0.001) most = std::max(most, std::abs(sut(x) - dead(x)));
    return most;
  };
  const auto near = nearest_table(-3.0, 3.0, dead);
  EXPECT_LE(near.low, -3.0);
  EXPECT_GE(near.high, 3.0);
  EXPECT_GT(miss(table(-3.0, 3.0, dead)), 0.002);
  EXPECT_LT(miss(near), 0.002);
}

TEST(ControlLawsTest, WhatIsHeldIsLevelBeyondItsEnds) {
  const cancellation::ValueTable channel(held(-2.0, 3.0));
  for (const double x : {-2.0, -0.3, 0.0, 2.9}) EXPECT_NEAR(channel(x), x, 1e-12);
  EXPECT_DOUBLE_EQ(channel(-50.0), -2.0);
  EXPECT_DOUBLE_EQ(channel(50.0), 3.0);
  const cancellation::ValueTable cube(held_table(-1.0, 2.0, [](double x) { return x * x * x; }));
  // A cell of 3/122 at a slope of 12: what a bend at the end is missed by, and the level is exact.
  EXPECT_NEAR(cube(2.0), 8.0, 0.1);
  EXPECT_DOUBLE_EQ(cube(50.0), 8.0);
  EXPECT_DOUBLE_EQ(cube(-50.0), -1.0);
}

// Straight lines between 129 values of tanh over +-8 transitions: h = 1/8, an error of
// h^2/8 max|tanh''| = 0.77 h^2/8 = 1.5e-3.
TEST(ControlLawsTest, FrictionIsASmoothSign) {
  constexpr double kTransition = 0.4;
  const auto sut = friction_path(Channel::kOmega, kTransition, -0.7);
  EXPECT_EQ(sut.channel, Channel::kOmega);
  EXPECT_EQ(sut.gain, -0.7);
  EXPECT_EQ(sut.lag_s, 0.0);
  EXPECT_EQ(sut.map.low, -sut.map.high);
  const auto last = static_cast<double>(sut.map.values.size() - 1);
  for (double v = sut.map.low; v < sut.map.high; v += 0.0173) {
    const double place = (v - sut.map.low) / (sut.map.high - sut.map.low) * last;
    const auto below = static_cast<std::size_t>(place);
    const double share = place - std::floor(place);
    const double got = (1.0 - share) * sut.map.values[below] + share * sut.map.values[below + 1];
    ASSERT_NEAR(got, std::tanh(v / kTransition), 1.6e-3) << v;
  }
}

// Outer lines continue beyond the table: at its end the map must be level, 1 - tanh(8) = 2e-7.
TEST(ControlLawsTest, FrictionIsLevelAtTheTablesEnds) {
  for (const double transition : {0.0, 0.05, 1.0, 20.0}) {
    const auto sut = friction_path(Channel::kOmega, transition, 1.0);
    const auto& values = sut.map.values;
    EXPECT_NEAR(values.back(), 1.0, 3e-7);
    EXPECT_NEAR(values.front(), -1.0, 3e-7);
    EXPECT_NEAR(values.back(), values[values.size() - 2], 1e-6);
  }
}

TEST(ControlLawsTest, ASignIsNeverSharperThanTheEncoderAllows) {
  const auto sharp = friction_path(Channel::kOmega, 0.0, 1.0);
  const auto narrow = friction_path(Channel::kOmega, 0.01, 1.0);
  const auto wide = friction_path(Channel::kOmega, 0.06, 1.0);
  EXPECT_EQ(sharp.map.high, narrow.map.high);
  EXPECT_EQ(sharp.map.values, narrow.map.values);
  EXPECT_GT(wide.map.high, sharp.map.high);
}

TEST(ControlLawsTest, WavesAreTheHarmonicsInOrder) {
  cancellation::ControlModel sut;
  add_waves({"tone", "", {}, {}, {1.0, 2.0, 3.0, 4.0}}, std::nullopt, 5.0, -1.0, sut);
  ASSERT_EQ(sut.waves.size(), 2u);
  EXPECT_FALSE(sut.waves[0].channel);
  EXPECT_EQ(sut.waves[0].frequency, 5.0);
  EXPECT_EQ(sut.waves[0].sine_n, -1.0);
  EXPECT_EQ(sut.waves[0].cosine_n, -2.0);
  EXPECT_EQ(sut.waves[1].frequency, 10.0);
  EXPECT_EQ(sut.waves[1].sine_n, -3.0);
  EXPECT_EQ(sut.waves[1].cosine_n, -4.0);
}

TEST(ControlLawsTest, WavesAreAppended) {
  cancellation::ControlModel sut;
  add_waves({"tone", "", {}, {}, {1.0, 2.0}}, std::nullopt, 5.0, 1.0, sut);
  add_waves({"position_ripple", "", {}, {}, {3.0, 4.0}}, Channel::kTheta, 7.0, 1.0, sut);
  add_waves({"tone", "", {}, {}, {}}, std::nullopt, 9.0, 1.0, sut);
  ASSERT_EQ(sut.waves.size(), 2u);
  EXPECT_EQ(sut.waves[1].channel, Channel::kTheta);
  EXPECT_EQ(sut.waves[1].frequency, 7.0);
}

}  // namespace
}  // namespace stillhand::close_the_loop::control_laws_test
