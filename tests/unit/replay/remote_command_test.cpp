// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/replay/remote.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::replay::remote_command_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

TEST(ParseCommandTest, AWordWithoutNumbersIsItsAction) {
  EXPECT_EQ(parse_command("play").action(), stillhand_msgs::REPLAY_PLAY);
  EXPECT_EQ(parse_command("pause").action(), stillhand_msgs::REPLAY_PAUSE);
  EXPECT_EQ(parse_command("step").action(), stillhand_msgs::REPLAY_STEP);
  EXPECT_EQ(parse_command("stop").action(), stillhand_msgs::REPLAY_STOP);
  EXPECT_EQ(parse_command("loop-off").action(), stillhand_msgs::REPLAY_LOOP_OFF);
  EXPECT_EQ(parse_command("  play\t").action(), stillhand_msgs::REPLAY_PLAY);
}

TEST(ParseCommandTest, NumbersReachTheFieldsOfTheirAction) {
  const auto seek = parse_command("seek 3.5");
  EXPECT_EQ(seek.action(), stillhand_msgs::REPLAY_SEEK);
  EXPECT_EQ(seek.from_s(), 3.5);
  const auto rate = parse_command("rate 0.25");
  EXPECT_EQ(rate.action(), stillhand_msgs::REPLAY_RATE);
  EXPECT_EQ(rate.rate(), 0.25);
  EXPECT_EQ(rate.from_s(), 0.0);
  const auto loop = parse_command("loop 1e1 12");
  EXPECT_EQ(loop.action(), stillhand_msgs::REPLAY_LOOP);
  EXPECT_EQ(loop.from_s(), 10.0);
  EXPECT_EQ(loop.to_s(), 12.0);
  // The player's own bounds decide about it, and their answer names them.
  EXPECT_EQ(parse_command("seek -1").from_s(), -1.0);
}

TEST(ParseCommandTest, EveryOtherTextIsRefusedWithTheCommandsThereAre) {
  for (const std::string bad :
       {"",           "dance",    "PLAY",      "seek",       "seek x",       "seek 1 2", "seek 1s",
        "seek 1,5",   "rate",     "rate fast", "loop 1",     "loop 1 2 3",   "play 1",   "stop now",
        "loop-off 1", "seek nan", "seek inf",  "seek 1e999", "loop 1 1e999", "play -",   "seek 3 +",
        "stop 1e999", "rate 1 0x"}) {
    EXPECT_THAT(support::refusal([&] { parse_command(bad); }),
                AllOf(StartsWith("--remote: "), HasSubstr(bad), HasSubstr("seek S"),
                      HasSubstr("loop-off")));
  }
}

}  // namespace
}  // namespace stillhand::replay::remote_command_test
