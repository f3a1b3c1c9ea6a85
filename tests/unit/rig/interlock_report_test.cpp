// SPDX-License-Identifier: Apache-2.0
#include "services/processes/rig/interlock_report.hpp"

#include <gtest/gtest.h>

namespace stillhand::rig::interlock_report_test {
namespace {

TEST(InterlockReportTest, ReportsTheOpeningAndTheZeroForceOnceEach) {
  InterlockReport sut;
  EXPECT_FALSE(sut.step(false, false, 9, 3.0).opened);
  const auto first = sut.step(true, false, 10, 3.0);
  EXPECT_TRUE(first.opened);
  EXPECT_FALSE(first.force_zero);
  EXPECT_FALSE(sut.step(true, false, 11, 1.0).opened);
  const auto zero = sut.step(true, false, 49, 0.0);
  EXPECT_TRUE(zero.force_zero);
  EXPECT_EQ(zero.after_ticks, 39);
  EXPECT_FALSE(sut.step(true, false, 50, 0.0).force_zero);
}

TEST(InterlockReportTest, ReportsAnOpeningOfTheNextTrialAgain) {
  InterlockReport sut;
  sut.step(true, false, 10, 0.0);
  sut.step(false, false, 11, 0.0);
  const auto notice = sut.step(true, false, 20, 0.0);
  EXPECT_TRUE(notice.opened);
  EXPECT_TRUE(notice.force_zero);
  EXPECT_EQ(notice.after_ticks, 0);
}

// Who pressed it waits for the answer, whatever had taken the force away before.
TEST(InterlockReportTest, ReportsAnEmergencyStopAfterAnotherOpening) {
  InterlockReport sut;
  sut.step(true, false, 10, 3.0);
  sut.step(true, false, 49, 0.0);
  const auto notice = sut.step(true, true, 60, 0.0);
  EXPECT_TRUE(notice.opened);
  EXPECT_TRUE(notice.force_zero);
  EXPECT_FALSE(sut.step(true, true, 61, 0.0).opened);
}

}  // namespace
}  // namespace stillhand::rig::interlock_report_test
