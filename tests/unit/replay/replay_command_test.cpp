// SPDX-License-Identifier: Apache-2.0
// The verb's command line, as far as it is refused before anything is on the bus.
#include "apps/replay/replay_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/verb.hpp"

namespace stillhand::replay::replay_command_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::string refusal_of(const std::vector<std::string>& words) {
  return support::refusal_of(add_replay_command, support::named("replay", words));
}

TEST(ReplayCommandTest, ARateOutsideItsBoundsOrWithFourDecimalsIsRefused) {
  for (const char* bad : {"0", "0.099", "100.001", "1.2345", "-1", "fast", "1e1", "nan"}) {
    EXPECT_THAT(refusal_of({"f.mcap", "--rate", bad}),
                AllOf(StartsWith("--rate: got " + std::string(bad)), HasSubstr("0.1 to 100")))
        << bad;
  }
}

TEST(ReplayCommandTest, ARemapIsTwoNamesOfTopics) {
  for (const char* bad : {"a", "=b", "a=", "="}) {
    EXPECT_THAT(
        refusal_of({"f.mcap", "--remap", bad}),
        AllOf(StartsWith("--remap: got " + std::string(bad)), HasSubstr("RECORDED=WRITTEN")))
        << bad;
  }
}

TEST(ReplayCommandTest, WithoutARecordingOrACommandThereIsNothingToPlay) {
  EXPECT_THAT(refusal_of({}), StartsWith("REC: "));
  EXPECT_THAT(refusal_of({"--rate", "2", "--remap", "a=b"}), StartsWith("REC: "));
}

TEST(ReplayCommandTest, TimesAreNumbersWithinFourMonths) {
  for (const char* option : {"--start", "--end", "--wait-seconds"}) {
    for (const char* bad : {"-1", "nan", "inf", "10000001", "soon"}) {
      EXPECT_THAT(refusal_of({"f.mcap", option, bad}),
                  AllOf(StartsWith("command line: "), HasSubstr(option)))
          << bad;
    }
  }
}

TEST(ReplayCommandTest, AnUnknownRemoteCommandIsRefusedBeforeTheBusIsJoined) {
  EXPECT_THAT(refusal_of({"--remote", "dance"}), StartsWith("--remote: got dance"));
}

}  // namespace
}  // namespace stillhand::replay::replay_command_test
