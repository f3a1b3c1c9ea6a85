// SPDX-License-Identifier: Apache-2.0
#include "services/system/process/interlock.hpp"

#include <gtest/gtest.h>

#include <random>

namespace stillhand::runtime::interlock_test {
namespace {

Trial trial_number(std::int64_t number, Tick start) {
  return {number, TrialPhase::kTracking, start, 100, 10};
}

TEST(InterlockTest, IsOpenOutsideATrial) {
  Interlock sut;
  EXPECT_FALSE(sut.step(Trial{}, 0, true));
  EXPECT_FALSE(sut.step(trial_number(0, 50), 39, true));
  EXPECT_TRUE(sut.step(trial_number(0, 50), 40, true));
  EXPECT_TRUE(sut.step(trial_number(0, 50), 159, true));
  EXPECT_FALSE(sut.step(trial_number(0, 50), 160, true));
}

TEST(InterlockTest, StaysOpenForTheTrialOnceAPeerWasMissing) {
  Interlock sut;
  const Trial trial = trial_number(3, 50);
  EXPECT_TRUE(sut.step(trial, 50, true));
  EXPECT_FALSE(sut.step(trial, 51, false));
  EXPECT_FALSE(sut.step(trial, 52, true));
  EXPECT_TRUE(sut.latched(trial));
}

TEST(InterlockTest, ClosesAgainForTheNextTrial) {
  Interlock sut;
  sut.step(trial_number(3, 50), 51, false);
  EXPECT_TRUE(sut.step(trial_number(4, 500), 500, true));
  EXPECT_FALSE(sut.latched(trial_number(4, 500)));
}

TEST(InterlockTest, IgnoresAMissingPeerBetweenTrials) {
  Interlock sut;
  const Trial trial = trial_number(0, 500);
  EXPECT_FALSE(sut.step(trial, 100, false));
  EXPECT_TRUE(sut.step(trial, 500, true));
}

TEST(InterlockTest, NeverClosesAfterAStop) {
  Interlock sut;
  EXPECT_TRUE(sut.step(trial_number(3, 50), 50, true));
  sut.stop();
  EXPECT_FALSE(sut.step(trial_number(3, 50), 51, true));
  EXPECT_FALSE(sut.step(trial_number(4, 500), 500, true));
  EXPECT_TRUE(sut.latched(trial_number(4, 500)));
  EXPECT_TRUE(sut.latched(Trial{}));
}

// Oracle: the doc comment, over the whole history of the run.
TEST(InterlockTest, NoSequenceOfTrialsDeathsAndStopsGivesAForceByItsOwnRules) {
  std::mt19937 random(20261123);
  int permitted = 0;
  for (int run = 0; run < 200; ++run) {
    Interlock sut;
    bool stopped = false, missed = false;
    Trial trial;
    for (Tick tick = 0; tick < 1000; ++tick) {
      if (tick % 250 == 0) {
        trial = trial_number(tick / 250, tick + 60);
        missed = false;
      }
      const bool alive = random() % 300 != 0;
      if (random() % 3000 == 0) {
        sut.stop();
        stopped = true;
      }
      const bool covered = tick >= trial.start_tick - 10 && tick < trial.start_tick + 110;
      missed = missed || (covered && !alive);
      const bool want = covered && alive && !missed && !stopped;
      ASSERT_EQ(sut.step(trial, tick, alive), want) << "run " << run << " tick " << tick;
      ASSERT_EQ(sut.latched(trial), missed || stopped) << "run " << run << " tick " << tick;
      permitted += want ? 1 : 0;
    }
  }
  EXPECT_GT(permitted, 20'000);
}

}  // namespace
}  // namespace stillhand::runtime::interlock_test
