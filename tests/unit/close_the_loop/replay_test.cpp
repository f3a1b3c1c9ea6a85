// SPDX-License-Identifier: Apache-2.0
// Recordings through a model, and through canceller and motor: METHOD Eq. CL-6.
#include "apps/close_the_loop/recorded/replay.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "services/core/contract/config_error.hpp"

namespace stillhand::close_the_loop::replay_test {
namespace {

constexpr double kGain = -3.0;  // [N s^2/m]

// f = gain a_y + 2 N, a_y of two sines, two stretches of `seconds`.
diagnosis::Measurement pegged(double rate_hz, double seconds) {
  diagnosis::Measurement out;
  out.source = "pegged";
  out.rate_hz = rate_hz;
  out.channels = {{"a_y", "m/s^2", {}}, {"f", "N", {}}};
  const auto samples = static_cast<std::size_t>(seconds * rate_hz);
  for (std::size_t n = 0; n < 2 * samples; ++n) {
    const double t = 2.0 * std::numbers::pi * static_cast<double>(n) / rate_hz;
    const double a = 1.5 * std::sin(0.9 * t) + std::sin(1.7 * t + 1.0);
    out.channels[0].values.push_back(a);
    out.channels[1].values.push_back(kGain * a + 2.0);
  }
  out.weight.assign(2 * samples, 1.0);
  out.stretches = {{0, samples, 0.0}, {samples, 2 * samples, 2.0 * seconds}};
  return out;
}

cancellation::ControlModel gain(double n_s2_m) {
  cancellation::ControlModel model;
  model.rate_hz = 1000.0;
  model.denominator = {1.0};
  model.inputs = {{cancellation::Channel::kAccelY, {}, {n_s2_m}}};
  return model;
}

// Oracle: a tick, and the lag of 1.5 ms on held commands, e^(-2/3) / (1 - e^(-2/3)) = 1.055 ticks.
// 2 pi f 2.055 ms of each sine is left, 1.16 % and 2.19 %; their RMS over that of the sum is 1.55
// %.
TEST(ReplayTest, TheMotorTakesAwayWhatItsDelayLetsIt) {
  for (const double rate_hz : {100.0, 1000.0, 610.35}) {
    const Remaining sut = left_by_motor(gain(kGain), pegged(rate_hz, 40.0), "f");
    EXPECT_NEAR(sut.without.rms, 3.0 * std::sqrt((1.5 * 1.5 + 1.0) / 2.0), 0.05);
    EXPECT_NEAR(sut.cut(), 1.0 - 0.0155, 0.0003) << rate_hz;
    ASSERT_TRUE(sut.cut_interval95());
    EXPECT_LE(sut.cut_interval95()->first, sut.cut() + 1e-4);
    EXPECT_GE(sut.cut_interval95()->second, sut.cut() - 1e-4);
  }
}

// The same with 14.055 ms: 7.9 % and 15 %, whose RMS is 10.6 %.
TEST(ReplayTest, ALateMotorPathLeavesMore) {
  EXPECT_NEAR(left_by_motor(gain(kGain), pegged(1000.0, 40.0), "f", 0.012).cut(), 1.0 - 0.106,
              0.001);
}

TEST(ReplayTest, AModelOfHalfTheGainTakesHalfAndOneOfTheWrongSignAdds) {
  EXPECT_NEAR(left_by_motor(gain(0.5 * kGain), pegged(200.0, 40.0), "f").cut(), 0.5, 0.01);
  EXPECT_NEAR(left_by_motor(gain(-kGain), pegged(200.0, 40.0), "f").cut(), -1.0, 0.02);
}

TEST(ReplayTest, TwoModelsAreJudgedOnTheSameSamples) {
  const auto record = pegged(200.0, 40.0);
  const double from_s = settled_after_s(gain(kGain)) + 3.0;
  const Remaining early = left_by_motor(gain(kGain), record, "f");
  const Remaining late = left_by_motor(gain(kGain), record, "f", 0.0, from_s);
  // 37.75 s and 34.75 s of each stretch: three blocks; other samples.
  EXPECT_EQ(late.left.block_mean_squares.size(), early.left.block_mean_squares.size());
  EXPECT_NE(late.without.block_mean_squares, early.without.block_mean_squares);
}

// 20 N/(m/s^2) of at most 2.5 m/s^2: more than the canceller's 25 N at the peaks alone.
TEST(ReplayTest, TheTimeAtTheLimitsIsCounted) {
  EXPECT_EQ(left_by_motor(gain(kGain), pegged(200.0, 40.0), "f").limited_share, 0.0);
  const double share = left_by_motor(gain(20.0), pegged(200.0, 40.0), "f").limited_share;
  EXPECT_GT(share, 0.0);
  EXPECT_LT(share, 1.0);
}

TEST(ReplayTest, RecordsArePooledOverTheirBlocksOrTheirTime) {
  const Level one{2.0, {}, {4.0, 4.0}};
  const Level two{1.0, {}, {1.0}};
  EXPECT_DOUBLE_EQ(pooled({one, two}, {20.0, 10.0}).rms, std::sqrt(3.0));
  EXPECT_TRUE(pooled({one, two}, {20.0, 10.0}).interval95);
  const Level brief{1.0, {}, {}};
  const Level sut = pooled({one, brief}, {20.0, 10.0});
  EXPECT_DOUBLE_EQ(sut.rms, std::sqrt(3.0)) << "4 for 20 s and 1 for 10 s";
  EXPECT_FALSE(sut.interval95);
}

TEST(ReplayTest, WhatAModelExplainsBeyondAnotherIsTheRootOfTheFall) {
  const Level before{5.0, {}, {25.0, 26.0, 24.0}};
  const Level after{4.0, {}, {16.0, 17.0, 15.0}};
  const Level sut = explained_beyond(before, after);
  EXPECT_DOUBLE_EQ(sut.rms, 3.0);
  EXPECT_EQ(sut.interval95, (std::pair{3.0, 3.0})) << "it falls by 9 in each block";
  EXPECT_EQ(explained_beyond(after, before).rms, 0.0);
}

TEST(ReplayTest, AShortRecordHasNoInterval) {
  const Remaining sut = left_by_motor(gain(kGain), pegged(200.0, 9.0), "f");
  EXPECT_FALSE(sut.without.interval95);
  EXPECT_FALSE(sut.cut_interval95());
  EXPECT_THROW(left_by_motor(gain(kGain), pegged(200.0, 1.5), "f"), ConfigError);
}

TEST(ReplayTest, AMissingChannelIsNamed) {
  EXPECT_THROW(left_by_motor(gain(kGain), pegged(200.0, 9.0), "force"), ConfigError);
}

TEST(ReplayTest, TheEndThatIsKeptApartGoesOnWhereTheRestEnds) {
  const auto [seen, unseen] = split_off_end(pegged(100.0, 40.0), 0.3);
  EXPECT_EQ(seen.size() + unseen.size(), 8000u);
  EXPECT_EQ(unseen.size(), 2400u);
  ASSERT_EQ(seen.stretches.size(), 2u);
  ASSERT_EQ(unseen.stretches.size(), 1u);
  EXPECT_EQ(seen.stretches[1].end, 5600u);
  EXPECT_NEAR(unseen.stretches[0].start_s, 80.0 + 16.0, 1e-9);
  diagnosis::check(seen);
  diagnosis::check(unseen);
}

}  // namespace
}  // namespace stillhand::close_the_loop::replay_test
