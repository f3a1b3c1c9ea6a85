// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/page/questions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace stillhand::diagnose::questions_test {

using testing::ElementsAre;

diagnosis::Detection answer(const char* question, const char* channel, double share) {
  return {question, channel, share, 0.5, share > 0.1, {channel}};
}

std::vector<std::string> channels_of(const std::vector<Answers>& answers) {
  std::vector<std::string> channels;
  for (const Answers& each : answers) channels.push_back(each.before.channel);
  return channels;
}

TEST(QuestionsTest, TheLargestShareBeforeOrAfterComesFirst) {
  diagnosis::Diagnosis found;
  found.before.detections = {answer("linear in", "u", 0.2), answer("linear in", "v", 0.05),
                             answer("linear in", "w", 0.3)};
  found.after.detections = {answer("linear in", "v", 0.4), answer("linear in", "u", 0.01)};
  EXPECT_THAT(channels_of(strongest_answers(found, 9)), ElementsAre("v", "w", "u"));
  EXPECT_THAT(channels_of(strongest_answers(found, 2)), ElementsAre("v", "w"));
  EXPECT_TRUE(strongest_answers(found, 0).empty());
}

TEST(QuestionsTest, AnswersOfOneQuestionAndChannelBelongTogether) {
  diagnosis::Diagnosis found;
  found.before.detections = {answer("linear in", "v", 0.3), answer("square of", "v", 0.2)};
  found.after.detections = {answer("square of", "v", 0.01), answer("linear in", "v", 0.02),
                            answer("linear in", "w", 0.9)};
  const auto sut = strongest_answers(found, 9);
  ASSERT_EQ(sut.size(), 2u) << "a question that was not asked before is not shown";
  EXPECT_EQ(sut[0].after.share, 0.02);
  EXPECT_EQ(sut[1].after.share, 0.01);
}

TEST(QuestionsTest, WhatWasNotAskedAgainHasNoSecondShare) {
  diagnosis::Diagnosis found;
  found.before.detections = {answer("linear in", "v", 0.3)};
  const auto sut = strongest_answers(found, 9);
  ASSERT_EQ(sut.size(), 1u);
  EXPECT_TRUE(std::isnan(sut[0].after.share));
  EXPECT_TRUE(std::isnan(sut[0].after.p));
  EXPECT_FALSE(sut[0].after.found);
  EXPECT_THAT(sut[0].after.channels, ElementsAre("v"));
}

TEST(QuestionsTest, EqualSharesKeepTheirOrder) {
  diagnosis::Diagnosis found;
  for (const char* channel : {"a", "b", "c", "d"}) {
    found.before.detections.push_back(answer("linear in", channel, 0.1));
  }
  EXPECT_THAT(channels_of(strongest_answers(found, 4)), ElementsAre("a", "b", "c", "d"));
  EXPECT_TRUE(strongest_answers({}, 4).empty());
}

}  // namespace stillhand::diagnose::questions_test
