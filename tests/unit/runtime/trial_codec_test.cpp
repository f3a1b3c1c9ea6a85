// SPDX-License-Identifier: Apache-2.0
#include "services/bus/trial_codec.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace stillhand::runtime::trial_codec_test {
namespace {

stillhand_msgs::TrialControl message() {
  stillhand_msgs::TrialControl control;
  control.trial(4);
  control.phase(stillhand_msgs::PHASE_TRACKING);
  control.start_tick(5000);
  control.duration_ticks(20'000);
  control.ramp_ticks(1000);
  return control;
}

TEST(TrialCodecTest, KeepsEveryTick) {
  const Trial trial = from_idl(message());
  EXPECT_EQ(trial.number, 4);
  EXPECT_EQ(trial.phase, TrialPhase::kTracking);
  EXPECT_EQ(trial.start_tick, 5000);
  EXPECT_EQ(trial.duration_ticks, 20'000);
  EXPECT_EQ(trial.ramp_ticks, 1000);
}

TEST(TrialCodecTest, TicksThatCannotBeAddedAreNoTrial) {
  constexpr Tick kMost = std::numeric_limits<Tick>::max();
  for (const Tick hostile : {Tick{-1}, -kMost, kMost, (Tick{1} << 60) + 1}) {
    auto start = message();
    start.start_tick(hostile);
    auto length = message();
    length.duration_ticks(hostile);
    auto ramp = message();
    ramp.ramp_ticks(hostile);
    for (const auto& control : {start, length, ramp}) {
      EXPECT_EQ(from_idl(control).number, -1) << hostile;
      EXPECT_FALSE(from_idl(control).covers(5000)) << hostile;
    }
  }
}

TEST(TrialCodecTest, TheLargestTicksThatCanBeAddedAreATrial) {
  auto control = message();
  control.start_tick(Tick{1} << 60);
  control.duration_ticks(Tick{1} << 60);
  control.ramp_ticks(Tick{1} << 60);
  const Trial trial = from_idl(control);
  EXPECT_EQ(trial.number, 4);
  EXPECT_TRUE(trial.covers(3 * (Tick{1} << 60) - 1));
  EXPECT_FALSE(trial.covers(3 * (Tick{1} << 60)));
}

// A phase of another version must not move anything.
TEST(TrialCodecTest, APhaseOfAnotherVersionCoversNoTick) {
  auto control = message();
  for (const auto phase : {stillhand_msgs::PHASE_IDLE, static_cast<stillhand_msgs::Phase>(77)}) {
    control.phase(phase);
    EXPECT_EQ(from_idl(control).phase, TrialPhase::kIdle);
    EXPECT_FALSE(from_idl(control).covers(5000));
    EXPECT_FALSE(from_idl(control).measures(5000));
  }
  control.phase(stillhand_msgs::PHASE_PEGGED);
  EXPECT_EQ(from_idl(control).phase, TrialPhase::kPegged);
}

}  // namespace
}  // namespace stillhand::runtime::trial_codec_test
