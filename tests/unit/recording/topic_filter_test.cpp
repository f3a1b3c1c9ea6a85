// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/topic_filter.hpp"

#include <gtest/gtest.h>

#include "tests/support/refusal.hpp"

namespace stillhand::recording::topic_filter_test {
namespace {

TEST(TopicFilterTest, PatternsMatchWhatTheySay) {
  EXPECT_TRUE(matches_pattern("stillhand/sensed", "stillhand/sensed"));
  EXPECT_FALSE(matches_pattern("stillhand/sensed", "stillhand/sensed2"));
  EXPECT_FALSE(matches_pattern("stillhand/sensed", "stillhand/sense"));
  EXPECT_TRUE(matches_pattern("*", ""));
  EXPECT_TRUE(matches_pattern("*", "a/b"));
  EXPECT_TRUE(matches_pattern("stillhand/*_command", "stillhand/motor_command"));
  EXPECT_FALSE(matches_pattern("stillhand/*_command", "stillhand/motor_commands"));
  EXPECT_TRUE(matches_pattern("a?c", "abc"));
  EXPECT_FALSE(matches_pattern("a?c", "ac"));
  EXPECT_TRUE(matches_pattern("*ab*ab", "xababab"));
  EXPECT_FALSE(matches_pattern("", "a"));
  EXPECT_TRUE(matches_pattern("", ""));
}

// A pattern of many stars against a long text that does not match takes years when each star tries
// every length for each of the others.
TEST(TopicFilterTest, ManyStarsCostNoMoreThanThePatternTimesTheText) {
  std::string pattern;
  for (int i = 0; i < 200; ++i) pattern += "*a";
  EXPECT_FALSE(matches_pattern(pattern + "b", std::string(20'000, 'a')));
}

TEST(TopicFilterTest, BlockedWinsOverAllowedAndNothingAllowedMeansAll) {
  EXPECT_TRUE((TopicFilter{{}, {}}).wants("x"));
  EXPECT_FALSE((TopicFilter{{}, {"x"}}).wants("x"));
  const TopicFilter sut{{"stillhand/*", "desk/*"}, {"*status"}};
  EXPECT_TRUE(sut.wants("stillhand/sensed"));
  EXPECT_TRUE(sut.wants("desk/lamp"));
  EXPECT_FALSE(sut.wants("stillhand/service_status"));
  EXPECT_FALSE(sut.wants("other/sensed"));
}

TEST(TopicFilterTest, TheTopicsOfARecordingAreNamedOnceEach) {
  const std::map<ChannelId, Channel> channels{
      {0, {0, 0, "b", "cdr", {}}}, {1, {1, 0, "a", "cdr", {}}}, {7, {7, 0, "b", "cdr", {}}}};
  EXPECT_EQ(one_of_topics(channels), "one of a, b");
  EXPECT_EQ(one_of_topics({}), "a recording with topics");
  require_each_matches({"a", "?"}, "--topics", channels);
  EXPECT_EQ(support::refusal([&] { require_each_matches({"a", "c*"}, "--block", channels); }),
            "--block: got c*, which no topic matches, want one of a, b");
}

}  // namespace
}  // namespace stillhand::recording::topic_filter_test
