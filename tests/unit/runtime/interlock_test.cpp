// SPDX-License-Identifier: Apache-2.0
#include "services/runtime/process/interlock.hpp"

#include <gtest/gtest.h>

namespace stillhand::runtime {
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

}  // namespace
}  // namespace stillhand::runtime
