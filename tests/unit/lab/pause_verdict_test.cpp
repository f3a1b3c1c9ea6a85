// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/pause_verdict.hpp"

#include <gtest/gtest.h>

#include "tests/unit/lab/pause_summary.hpp"

namespace stillhand::lab::pause_verdict_test {
namespace {

TEST(PauseVerdictTest, CPlusThatLeavesLessIsOnOffer) {
  const PauseVerdict sut = pause_verdict(pause_summary().dump());
  EXPECT_EQ(sut.why_not, "");
  EXPECT_EQ(
      sut.found,
      "dead_zone: leaves 0.81 N where a linear model leaves 1.46 N, in 36 s that no fit has seen");
  EXPECT_TRUE(sut.certain);
}

TEST(PauseVerdictTest, WhatTheLoopDoesNotKeepIsNotOnOffer) {
  auto summary = pause_summary();
  summary["kept"] = false;  // the interval holds 0
  EXPECT_EQ(pause_verdict(summary.dump()).why_not,
            "C+ (dead_zone) would leave 0.81 N where it leaves 1.46 N, which may be chance");
}

TEST(PauseVerdictTest, WhatLeavesMoreIsNotOnOffer) {
  auto summary = pause_summary();
  summary["kept"] = false;
  summary["decision"]["augmented"]["rms"] = 1.5;
  summary["decision"]["less"] = -0.026;
  EXPECT_EQ(pause_verdict(summary.dump()).why_not,
            "C+ (dead_zone) would leave 1.50 N where it leaves 1.46 N");
}

TEST(PauseVerdictTest, AGainWithoutAnIntervalIsOnOfferAndNotCertain) {
  auto summary = pause_summary();
  summary["decision"]["less_interval95"] = nullptr;
  const PauseVerdict sut = pause_verdict(summary.dump());
  EXPECT_EQ(sut.why_not, "");
  EXPECT_FALSE(sut.certain);
}

TEST(PauseVerdictTest, NamesWhatIsCancelledAlone) {
  auto summary = pause_summary();
  summary["treatments"] = {{{"kind", "tone"}, {"cancelled", false}, {"how", "a fit lacks it"}},
                           {{"kind", "asymmetry"}, {"cancelled", true}, {"how", "in the body"}}};
  EXPECT_EQ(pause_verdict(summary.dump()).found.find("asymmetry: "), 0u);
  summary["treatments"].erase(1);
  EXPECT_EQ(pause_verdict(summary.dump()).why_not, "tone is left alone: a fit lacks it");
}

TEST(PauseVerdictTest, NothingMissingNothingOnOffer) {
  auto summary = pause_summary();
  summary["verdict"]["kind"] = "none";
  EXPECT_EQ(pause_verdict(summary.dump()).why_not, "nothing that counts is missing in it");
}

TEST(PauseVerdictTest, WhatTheCancellerRefusesIsNotOnOffer) {
  auto summary = pause_summary();
  summary["not_carried"] = "the canceller refuses it: unstable";
  EXPECT_EQ(pause_verdict(summary.dump()).why_not,
            "dead_zone is not carried: the canceller refuses it: unstable");
}

}  // namespace
}  // namespace stillhand::lab::pause_verdict_test
