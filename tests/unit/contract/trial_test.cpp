// SPDX-License-Identifier: Apache-2.0
#include "services/core/contract/trial.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

namespace stillhand::trial_test {
namespace {

constexpr Tick kLast = Tick{1} << 60;

Trial trial_of(Tick start, Tick duration, Tick ramp, TrialPhase phase = TrialPhase::kTracking) {
  Trial trial;
  trial.number = 0;
  trial.phase = phase;
  trial.start_tick = start;
  trial.duration_ticks = duration;
  trial.ramp_ticks = ramp;
  return trial;
}

TEST(TrialTest, TheFirstTickOfEachPartBelongsToItAndTheFirstAfterItDoesNot) {
  const Trial sut = trial_of(100, 50, 20);
  EXPECT_FALSE(sut.covers(79));
  EXPECT_TRUE(sut.covers(80));
  EXPECT_FALSE(sut.measures(99));
  EXPECT_TRUE(sut.measures(100));
  EXPECT_TRUE(sut.measures(149));
  EXPECT_FALSE(sut.measures(150));
  EXPECT_TRUE(sut.covers(169));
  EXPECT_FALSE(sut.covers(170));
}

TEST(TrialTest, AnIdleTrialCoversAndMeasuresNothing) {
  const Trial sut = trial_of(0, 1000, 100, TrialPhase::kIdle);
  for (Tick tick = -200; tick < 1300; tick += 10) {
    EXPECT_FALSE(sut.covers(tick)) << tick;
    EXPECT_FALSE(sut.measures(tick)) << tick;
  }
  EXPECT_FALSE(Trial{}.covers(0));
}

TEST(TrialTest, AnEmptyTrialMeasuresNothingAndCoversItsRampsAlone) {
  EXPECT_FALSE(trial_of(10, 0, 0).covers(10));
  const Trial sut = trial_of(10, 0, 3);
  EXPECT_FALSE(sut.measures(10));
  EXPECT_TRUE(sut.covers(7));
  EXPECT_TRUE(sut.covers(12));
  EXPECT_FALSE(sut.covers(13));
}

// Counted tick by tick: as many ticks as the parts are long, and no measured tick outside.
TEST(TrialTest, AsManyTicksAreCoveredAsThePartsAreLong) {
  std::mt19937_64 engine(21);
  std::uniform_int_distribution<Tick> start(0, 300);
  std::uniform_int_distribution<Tick> length(0, 200);
  for (int i = 0; i < 200; ++i) {
    const Trial sut = trial_of(start(engine), length(engine), length(engine) / 4,
                               i % 2 == 0 ? TrialPhase::kPegged : TrialPhase::kTracking);
    Tick covered = 0;
    Tick measured = 0;
    for (Tick tick = -100; tick < 700; ++tick) {
      covered += sut.covers(tick) ? 1 : 0;
      measured += sut.measures(tick) ? 1 : 0;
      ASSERT_FALSE(sut.measures(tick) && !sut.covers(tick)) << "trial " << i << ", tick " << tick;
    }
    ASSERT_EQ(measured, sut.duration_ticks);
    ASSERT_EQ(covered, sut.duration_ticks + 2 * sut.ramp_ticks);
  }
}

TEST(TrialTest, EveryPartIsSoundFromZeroToTwoToTheSixty) {
  EXPECT_TRUE(trial_of(0, 0, 0).sound());
  EXPECT_TRUE(trial_of(kLast, kLast, kLast).sound());
  for (const Tick wrong :
       {Tick{-1}, kLast + 1, std::numeric_limits<Tick>::min(), std::numeric_limits<Tick>::max()}) {
    EXPECT_FALSE(trial_of(wrong, 1, 1).sound()) << wrong;
    EXPECT_FALSE(trial_of(1, wrong, 1).sound()) << wrong;
    EXPECT_FALSE(trial_of(1, 1, wrong).sound()) << wrong;
  }
}

// sound() promises that sums of its parts stay within 64 bits: 3 * 2^60 < 2^63.
TEST(TrialTest, TheLargestSoundTrialHasItsBoundsWhereTheyBelong) {
  const Trial sut = trial_of(kLast, kLast, kLast);
  EXPECT_TRUE(sut.covers(0));
  EXPECT_FALSE(sut.covers(-1));
  EXPECT_TRUE(sut.measures(2 * kLast - 1));
  EXPECT_FALSE(sut.measures(2 * kLast));
  EXPECT_TRUE(sut.covers(3 * kLast - 1));
  EXPECT_FALSE(sut.covers(3 * kLast));
}

}  // namespace
}  // namespace stillhand::trial_test
