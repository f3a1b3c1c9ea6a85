// SPDX-License-Identifier: Apache-2.0
// The verb's command line, as far as it is refused before anything is on the bus.
#include "apps/record/record_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/verb.hpp"

namespace stillhand::record::record_command_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::string refusal_of(const std::vector<std::string>& words) {
  return support::refusal_of(add_record_command, support::named("record", words));
}

TEST(RecordCommandTest, AFileToWriteIsWantedUnlessACommandIsSent) {
  EXPECT_THAT(refusal_of({}), StartsWith("--out: "));
  EXPECT_THAT(refusal_of({"--duration", "1"}), StartsWith("--out: "));
  EXPECT_THAT(refusal_of({"--remote", "dance"}),
              AllOf(StartsWith("--remote: got dance"), HasSubstr("pause"), HasSubstr("resume"),
                    HasSubstr("trigger"), HasSubstr("stop")));
}

// Without a window every message is written, so there is nothing to trigger.
TEST(RecordCommandTest, ATriggerWithoutAWindowIsRefused) {
  for (const std::vector<std::string>& trigger :
       {std::vector<std::string>{"--trigger", "stillhand/sensed.force_n>5"},
        std::vector<std::string>{"--trigger-on-deadline"}}) {
    std::vector<std::string> words{"--out", "f.mcap"};
    words.insert(words.end(), trigger.begin(), trigger.end());
    EXPECT_THAT(refusal_of(words), AllOf(StartsWith("--trigger: "), HasSubstr("--window")));
  }
}

TEST(RecordCommandTest, NumbersOutsideTheirBoundsAreRefusedByTheirOption) {
  const std::pair<const char*, std::vector<const char*>> options[]{
      {"--duration", {"0", "-1", "nan", "inf", "10000001", "long"}},
      {"--rotate-s", {"0.09", "nan", "10000001"}},
      {"--rotate-mb", {"0.09", "nan", "1000000001"}},
      {"--window", {"0.09", "nan", "3601"}},
      {"--flush-ms", {"9", "801", "x"}},
      {"--min-free-mb", {"-1", "nan"}},
      {"--domain", {"-1", "x"}}};
  for (const auto& [option, values] : options) {
    for (const char* bad : values) {
      EXPECT_THAT(refusal_of({"--out", "f.mcap", option, bad}),
                  AllOf(StartsWith("command line: "), HasSubstr(option)))
          << option << " " << bad;
    }
  }
}

TEST(RecordCommandTest, AnUnknownCompressionNamesThoseThereAre) {
  EXPECT_THAT(refusal_of({"--out", "f.mcap", "--compression", "zip"}),
              AllOf(StartsWith("command line: "), HasSubstr("zstd"), HasSubstr("lz4")));
}

}  // namespace
}  // namespace stillhand::record::record_command_test
