// SPDX-License-Identifier: Apache-2.0
#include "services/core/display/answering.hpp"

#include <gtest/gtest.h>

namespace stillhand::display::answering_test {

class AnsweringTest : public testing::Test {
 protected:
  AnsweringTest() { show(4, 7); }
  void show(std::uint64_t number, std::int64_t steps) {
    Prompt prompt;
    prompt.number = number;
    prompt.kind = PromptKind::kQuestion;
    prompt.steps = steps;
    sut_.show(prompt);
  }
  Answering sut_;
};

TEST_F(AnsweringTest, AChoiceIsNoAnswerBeforeItIsConfirmed) {
  sut_.confirm();
  EXPECT_FALSE(sut_.answer()) << "nothing is chosen";
  sut_.choose(3);
  EXPECT_EQ(sut_.chosen(), 3);
  EXPECT_FALSE(sut_.answer());
  sut_.choose(5);
  sut_.confirm();
  ASSERT_TRUE(sut_.answer());
  EXPECT_EQ(sut_.answer()->prompt, 4u);
  EXPECT_EQ(sut_.answer()->value, 5);
}

TEST_F(AnsweringTest, LeftAndRightChooseTheNeighbourWithinTheScale) {
  sut_.move(1);
  EXPECT_EQ(sut_.chosen(), 1);
  sut_.move(-1);
  EXPECT_EQ(sut_.chosen(), 1);
  for (int i = 0; i < 9; ++i) sut_.move(1);
  EXPECT_EQ(sut_.chosen(), 7);
  show(5, 7);
  sut_.move(-1);
  EXPECT_EQ(sut_.chosen(), 7);
  sut_.move(-1);
  sut_.confirm();
  sut_.move(1);
  ASSERT_TRUE(sut_.answer());
  EXPECT_EQ(sut_.answer()->value, 6);
  show(6, 0);
  sut_.move(1);
  sut_.move(-1);
  EXPECT_EQ(sut_.chosen(), 0);
}

TEST_F(AnsweringTest, AValueBeyondTheScaleIsNotChosen) {
  for (const std::int64_t value : {0, -1, 8, 9, 1000}) sut_.choose(value);
  EXPECT_EQ(sut_.chosen(), 0);
}

TEST_F(AnsweringTest, AConfirmedAnswerStays) {
  sut_.choose(2);
  sut_.confirm();
  sut_.choose(6);
  sut_.confirm();
  EXPECT_EQ(sut_.answer()->value, 2);
  EXPECT_EQ(sut_.chosen(), 2);
}

TEST_F(AnsweringTest, TheNextPromptForgetsAndTheSamePromptDoesNot) {
  sut_.choose(2);
  show(4, 7);
  EXPECT_EQ(sut_.chosen(), 2);
  sut_.confirm();
  show(5, 7);
  EXPECT_EQ(sut_.chosen(), 0);
  EXPECT_FALSE(sut_.answer());
}

TEST_F(AnsweringTest, APromptWithOneStepIsConfirmedAtOnce) {
  show(5, 1);
  sut_.confirm();
  ASSERT_TRUE(sut_.answer());
  EXPECT_EQ(sut_.answer()->value, 1);
}

TEST_F(AnsweringTest, APromptWithoutStepsTakesNoAnswer) {
  show(5, 0);
  sut_.choose(1);
  sut_.confirm();
  EXPECT_FALSE(sut_.answer());
}

}  // namespace stillhand::display::answering_test
