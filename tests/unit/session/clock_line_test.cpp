// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/clock_line.hpp"

#include <gtest/gtest.h>

namespace stillhand::session::clock_line_test {
namespace {

stillhand_msgs::ClockOffset offset(const char* service, std::int64_t stamp_ns,
                                   std::int64_t offset_ns, double uncertainty_ns) {
  stillhand_msgs::ClockOffset message;
  message.service(service);
  message.stamp_ns(stamp_ns);
  message.offset_ns(offset_ns);
  message.uncertainty_ns(uncertainty_ns);
  return message;
}

// The rig's clock is 1,000,000 ns ahead, and 500 ns more from the experiment's 2000 ns on.
const std::vector<stillhand_msgs::ClockOffset> kOffsets{offset("rig", 1000, 1'000'000, 40.0),
                                                        offset("sensing", 1000, -7, 90.0),
                                                        offset("rig", 2000, 1'000'500, 60.0)};

TEST(ClockLineTest, AStampIsTakenOverByTheOffsetKnownThen) {
  const ClockLine sut(kOffsets, "rig");
  EXPECT_EQ(sut.on_experiments_clock(1'001'100), 1'100);
  EXPECT_EQ(sut.on_experiments_clock(1'002'499), 2'499);
  EXPECT_EQ(sut.on_experiments_clock(1'002'500), 2'000);
  EXPECT_EQ(sut.on_experiments_clock(1'009'500), 9'000);
}

TEST(ClockLineTest, BeforeTheFirstOffsetThatOneHolds) {
  EXPECT_EQ(ClockLine(kOffsets, "rig").on_experiments_clock(1'000'100), 100);
}

TEST(ClockLineTest, AnUnknownClockIsTheExperimentsOwn) {
  EXPECT_EQ(ClockLine(kOffsets, "motion").on_experiments_clock(1'000'100), 1'000'100);
  EXPECT_EQ(ClockLine({}, "rig").uncertainty_ns(), 0.0);
}

TEST(ClockLineTest, TheUncertaintyIsTheWorstOfTheProcess) {
  EXPECT_EQ(ClockLine(kOffsets, "rig").uncertainty_ns(), 60.0);
}

}  // namespace
}  // namespace stillhand::session::clock_line_test
