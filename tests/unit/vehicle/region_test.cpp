// SPDX-License-Identifier: Apache-2.0
#include "apps/vehicle/region.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "apps/vehicle/region_output.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::vehicle::region_test {
namespace {

RegionOptions small() {
  RegionOptions options;
  options.subjects = 1;
  options.delays_s = {0.1};
  options.gains_m_s2_rad = {5.0, 40.0, 100.0};
  options.drive_s = 8.0;
  options.identify.pegged_s = 40.0;
  options.identify.periods = 4;
  return options;
}

Region mapped(const RegionOptions& options) {
  return map_region(options, [](const char*, double) { return true; });
}

class RegionTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { region_ = new Region(mapped(small())); }
  static void TearDownTestSuite() { delete region_; }
  static const Region& region() { return *region_; }
  static Region* region_;
};
Region* RegionTest::region_ = nullptr;

// Far from the limits on both sides, so that no draw of a subject's forces decides: predicted for
// this subject is some 13 m/s^2 per rad without and more than 30 with cancellation.
TEST_F(RegionTest, ALowGainIsStableAndAHighOneIsEnded) {
  for (const Drive& run : region().runs) {
    if (run.gain_m_s2_rad < 10.0 || run.gain_m_s2_rad > 90.0) {
      EXPECT_EQ(run.outcome.ended, run.gain_m_s2_rad > 90.0);
    }
  }
}

TEST_F(RegionTest, CancellationRaisesTheCriticalGain) {
  ASSERT_EQ(region().limits.size(), 2u);
  const Limit& without = region().limits[0];
  const Limit& with = region().limits[1];
  EXPECT_FALSE(without.cancel);
  // Well apart: the intervals of the two do not meet.
  EXPECT_GT(with.predicted.low_m_s2_rad, without.predicted.high_m_s2_rad);
  EXPECT_LE(without.predicted.low_m_s2_rad, without.predicted.gain_m_s2_rad);
  EXPECT_GE(without.predicted.high_m_s2_rad, without.predicted.gain_m_s2_rad);
  EXPECT_GT(without.predicted.gain_m_s2_rad, 5.0);
  EXPECT_LT(without.predicted.gain_m_s2_rad, 40.0);
}

// The rig's own limits, and those of the end: force envelope of 40 ticks, braking with 3 m/s^2 from
// at most 1.25 m/s.
TEST_F(RegionTest, AnEndedDriveStandsStillWithTheMotorAtZero) {
  int ended = 0;
  for (const Drive& run : region().runs) {
    EXPECT_LE(run.outcome.farthest_m, 0.15);
    EXPECT_LE(run.outcome.fastest_m_s, 1.25);
    EXPECT_LE(run.outcome.hardest_m_s2, 9.0);
    if (!run.outcome.ended) continue;
    ++ended;
    EXPECT_GT(run.outcome.rest_s, 0.0);
    EXPECT_LE(run.outcome.rest_s, 1.25 / 3.0 + 0.02);  // and the lead
    EXPECT_GT(run.outcome.motor_zero_s, 0.0);
    EXPECT_LE(run.outcome.motor_zero_s, 0.041);
    EXPECT_LE(run.outcome.periods_from_ceiling, 2.0);
  }
  EXPECT_GE(ended, 2);
}

TEST_F(RegionTest, TheResultsDoNotDependOnTheNumberOfThreads) {
  RegionOptions options = small();
  options.threads = 3;
  const Region again = mapped(options);
  EXPECT_EQ(runs_csv(again), runs_csv(region()));
  EXPECT_EQ(limits_csv(again), limits_csv(region()));
  EXPECT_EQ(region_json(options, again), region_json(small(), region()));
}

TEST(RegionOptionsTest, GainsThatDoNotRiseAndAShortDelayAreNamed) {
  RegionOptions options = small();
  options.gains_m_s2_rad = {5.0, 5.0};
  EXPECT_THROW(mapped(options), ConfigError);
  options = small();
  options.delays_s = {0.01};
  EXPECT_THROW(mapped(options), ConfigError);
}

TEST(RegionOptionsTest, AStopGivesNothing) {
  const Region region = map_region(small(), [](const char*, double) { return false; });
  EXPECT_TRUE(region.runs.empty());
}

// Ratio and interval of two limits by hand: 10 over sqrt(8 * 12.5) = 1, 30 over sqrt(40 * 62.5) =
// 0.6; the first interval meets its step, the second does not.
TEST(AgreementTest, ComparesPredictionAndStep) {
  const Limit near{.predicted = {10.0, 9.0, 11.0}, .stable_m_s2_rad = 8.0, .ended_m_s2_rad = 12.5};
  Limit far = near;
  far.predicted = {30.0, 29.0, 31.0};
  far.stable_m_s2_rad = 40.0;
  far.ended_m_s2_rad = 62.5;
  const Agreement sut = agreement({near, far}, false);
  EXPECT_EQ(sut.limits, 2);
  EXPECT_EQ(sut.within, 1);
  EXPECT_NEAR(sut.least, 0.6, 1e-12);
  EXPECT_NEAR(sut.most, 1.0, 1e-12);
  EXPECT_EQ(agreement({near, far}, true).limits, 0);
}

TEST(AgreementTest, CountsWhatHasNoStepToCompareWith) {
  Limit never;
  never.predicted = {30.0, 29.0, 31.0};
  never.stable_m_s2_rad = 100.0;
  never.ended_m_s2_rad = std::numeric_limits<double>::infinity();
  Limit beyond = never;
  beyond.predicted = {120.0, 80.0, 160.0};
  Limit at_once = never;
  at_once.stable_m_s2_rad = 0.0;
  at_once.ended_m_s2_rad = 1.0;
  const Agreement sut = agreement({never, beyond, at_once}, false);
  EXPECT_EQ(sut.limits, 0);
  EXPECT_EQ(sut.never_ended, 1);
  EXPECT_EQ(sut.beyond, 1);
  EXPECT_EQ(sut.at_once, 1);
}

}  // namespace
}  // namespace stillhand::vehicle::region_test
