// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "apps/recordings/info.hpp"

namespace stillhand::recordings::info_output_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

RecordingInfo info() {
  RecordingInfo info;
  info.path = "a.mcap";
  info.bytes = 1'234'000;
  info.program = "stillhand";
  info.profile = "x-stillhand";
  info.whole = true;
  info.messages = 3;
  info.start_ns = 1'795'272'703'845'833'285;
  info.end_ns = info.start_ns + 2'500'000'000;
  return info;
}

// 1795272703 s after 1970: the calendar of `date --utc`.
TEST(InfoTextTest, TheStartIsACalendarTimeInUtcAndTheLengthIsInSeconds) {
  EXPECT_THAT(info_text(info()), AllOf(HasSubstr("2026-11-21 14:51:43 UTC"), HasSubstr("2.500 s"),
                                       HasSubstr("3 messages"), HasSubstr("1.23 MB")));
}

TEST(InfoTextTest, ALogTimeBefore2000IsSecondsOfAClockThatIsNoCalendar) {
  RecordingInfo sut = info();
  sut.start_ns = 946'684'799'999'999'999;
  sut.end_ns = sut.start_ns;
  EXPECT_THAT(info_text(sut), AllOf(HasSubstr("946684800.000 s"), Not(HasSubstr("UTC"))));
  sut.start_ns = sut.end_ns = 946'684'800'000'000'000;
  EXPECT_THAT(info_text(sut), HasSubstr("2000-01-01 00:00:00 UTC"));
  sut.start_ns = sut.end_ns = UINT64_MAX;
  EXPECT_THAT(info_text(sut), HasSubstr("2554-07-21 23:34:33 UTC"));
}

TEST(InfoTextTest, NoTextOfAFileMovesTheCursorOfATerminal) {
  RecordingInfo sut = info();
  const std::string hostile = "x\x1b[2J\x07\r\n\x7f";
  sut.path = sut.program = sut.profile = hostile;
  sut.metadata = {{hostile, {{hostile, hostile}}}};
  sut.damage = {{recording::DamageKind::kBadChunk, 5, 6, hostile}};
  TopicInfo topic;
  topic.topic = topic.type = hostile;
  sut.topics = {topic};
  for (const char c : info_text(sut) + damage_text(sut.damage)) {
    EXPECT_TRUE(c == '\n' || (c >= ' ' && c != '\x7f')) << static_cast<int>(c);
  }
  const auto json = nlohmann::json::parse(info_json(sut));
  EXPECT_EQ(json.at("program"), hostile) << "JSON keeps the text, escaped";
}

TEST(InfoTextTest, TenFindingsAreListedAndTheOthersCounted) {
  RecordingInfo sut = info();
  sut.whole = false;
  for (std::uint64_t i = 0; i < 13; ++i) {
    sut.damage.push_back({recording::DamageKind::kBadChunk, 1000 + i, 100, "chunk lost"});
    sut.lost_bytes += 100;
  }
  const std::string text = info_text(sut);
  EXPECT_THAT(text, AllOf(HasSubstr("byte 1009: chunk lost"), Not(HasSubstr("byte 1010")),
                          HasSubstr("3 more"), HasSubstr("1.3 kB")));
  const auto json = nlohmann::json::parse(info_json(sut));
  ASSERT_EQ(json.at("damage").size(), 13u);
  EXPECT_EQ(json.at("damage")[12].at("offset"), 1012);
  EXPECT_EQ(json.at("lost_bytes"), 1300);
}

TEST(InfoTextTest, DamageWithoutALossStatesNoBytes) {
  EXPECT_EQ(damage_text({}), "");
  EXPECT_EQ(damage_text({{recording::DamageKind::kNoFooter, 77, 0, "no footer"}}),
            "byte 77: no footer\n");
  EXPECT_THAT(damage_text({{recording::DamageKind::kCutOff, 77, 1, "cut"}}),
              AllOf(HasSubstr("byte 77: cut"), HasSubstr("1 byte lost")));
}

TEST(InfoTextTest, TopicsStandInColumnsWithADashForWhatIsNotCounted) {
  RecordingInfo sut = info();
  TopicInfo counted;
  counted.topic = "stillhand/sensed";
  counted.type = "stillhand_msgs::Sensed";
  counted.messages = 200;
  counted.rate_hz = 999.996;
  counted.lost_ticks = 2;
  TopicInfo strange;
  strange.topic = "s";
  sut.topics = {counted, strange};
  const std::string text = info_text(sut);
  const auto row_of = [&](const std::string& begin) {
    const std::size_t at = text.find("\n" + begin + " ") + 1;
    return text.substr(at, text.find('\n', at) - at);
  };
  const std::string first = row_of("stillhand/sensed"), second = row_of("s");
  EXPECT_THAT(first, testing::EndsWith("         2"));
  EXPECT_THAT(first, HasSubstr("1000  "));
  EXPECT_THAT(second, HasSubstr(" ?  "));
  EXPECT_THAT(second, testing::EndsWith("-           -"));
  EXPECT_EQ(first.size(), second.size());
}

TEST(InfoJsonTest, TextsThatAreNotUtf8AreStillJsonAndUncountedTicksAreNull) {
  RecordingInfo sut = info();
  sut.program = "\xff";
  TopicInfo topic;
  topic.topic = "\xc3\x28";
  sut.topics = {topic};
  const auto json = nlohmann::json::parse(info_json(sut));
  EXPECT_TRUE(json.at("topics")[0].at("lost_ticks").is_null());
  EXPECT_EQ(json.at("duration_s"), 2.5);
  EXPECT_EQ(json.at("start_ns"), 1'795'272'703'845'833'285u) << "every digit";
}

}  // namespace
}  // namespace stillhand::recordings::info_output_test
