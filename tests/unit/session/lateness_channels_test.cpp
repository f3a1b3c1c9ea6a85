// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/lateness_channels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "tests/support/stalled_session.hpp"

namespace stillhand::session::lateness_channels_test {
namespace {

double sum_of(const recording::Recording& rows, const char* channel) {
  const auto& values = rows.find(channel)->values;
  return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(LatenessChannelsTest, HoldWhatTheStallsDidTickByTick) {
  constexpr Tick kStall = 73;
  const auto made = tests::stalled_session({.stall_ticks = kStall});
  const SessionRecording& session = made.recording;
  const recording::Recording sut = lateness_channels(session);
  ASSERT_EQ(sut.row_count(), session.rig_truths.size());
  const auto lost = static_cast<double>(session.raw_samples.size() - session.motor_commands.size());
  EXPECT_GT(lost, 30.0 * kStall);
  EXPECT_EQ(sum_of(sut, "answer_lost"), lost);
  EXPECT_EQ(sum_of(sut, "answer_repeated"), lost);
  EXPECT_EQ(sum_of(sut, "answer_later"), 0.0);
  EXPECT_EQ(std::ranges::max(sut.find("answer_age")->values), 1e-3 * kStall);
  EXPECT_EQ(sut.find("answer_age")->unit, "s");
  EXPECT_EQ(sut.find("interlock_closed")->values.front(), 0.0);
  EXPECT_EQ(sut.find("interlock_closed")->values.back(), 1.0);
}

// The rig uses none that is too old, and says so with -1.
TEST(LatenessChannelsTest, AgeGrowsWhereNoAnswerIsUsed) {
  auto session = tests::stalled_session({}).recording;
  for (auto& truth : session.rig_truths) {
    if (truth.tick() >= 100 && truth.tick() < 120) truth.motor_tick(-1);
    if (truth.tick() == 150) truth.motor_tick(149);
  }
  const recording::Recording sut = lateness_channels(session);
  EXPECT_DOUBLE_EQ(sut.find("answer_age")->values[119], 0.020);
  EXPECT_EQ(sut.find("answer_repeated")->values[119], 0.0);
  EXPECT_EQ(sut.find("answer_age")->values[120], 0.0);
  EXPECT_DOUBLE_EQ(sut.find("answer_age")->values[150], 0.001);
  EXPECT_EQ(sut.find("answer_later")->values[150], 1.0);
}

}  // namespace
}  // namespace stillhand::session::lateness_channels_test
