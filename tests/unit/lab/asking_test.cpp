// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/core/asking.hpp"

#include "tests/unit/lab/stage_fixture.hpp"

namespace stillhand::lab::asking_test {
namespace {

class AskingTest : public StageTest {
 protected:
  Actions answered(std::uint64_t prompt, std::int64_t value) {
    seen_.answers.push_back({prompt, value});
    return step(sut_);
  }
  Asking sut_{"question effort", 4, 7, std::nullopt, trouble_};
};

TEST_F(AskingTest, AnAnswerOfTheScaleEndsIt) {
  EXPECT_TRUE(step(sut_).progress);
  EXPECT_FALSE(sut_.over());
  answered(4, 6);
  EXPECT_TRUE(sut_.over());
  EXPECT_EQ(sut_.answer(), 6);
  EXPECT_TRUE(seen_.answers.empty());
}

TEST_F(AskingTest, AnAnswerBeyondTheScaleIsRefusedWithOneNote) {
  EXPECT_EQ(answered(4, 8).note, "answer 8 to prompt 4 is not taken: want 1 to 7 to prompt 4");
  for (const std::int64_t value : {0, -3, 100}) EXPECT_FALSE(answered(4, value).note);
  EXPECT_FALSE(sut_.over());
  answered(4, 7);
  EXPECT_EQ(sut_.answer(), 7);
}

TEST_F(AskingTest, AnAnswerToAnEarlierPromptIsARepetition) {
  EXPECT_FALSE(answered(3, 2).note);
  EXPECT_FALSE(sut_.over());
}

TEST_F(AskingTest, AnAnswerToAPromptThatIsNotShownYetIsRefused) {
  EXPECT_TRUE(answered(5, 2).note);
  EXPECT_FALSE(sut_.over());
}

TEST_F(AskingTest, TheFirstAnswerCounts) {
  seen_.answers.push_back({4, 2});
  answered(4, 3);
  EXPECT_EQ(sut_.answer(), 2);
}

TEST_F(AskingTest, ARequestForAStartGoesOnWithoutAnAnswer) {
  step(sut_);
  seen_.requests.take({Action::kStart, 1, "desk", ""}, false);
  step(sut_);
  EXPECT_TRUE(sut_.over());
  EXPECT_FALSE(sut_.answer());
}

TEST_F(AskingTest, ItWaitsForAPersonWithoutALimitUnlessThereIsOne) {
  step(sut_);
  step(sut_, 36'000 * kSecond);
  EXPECT_FALSE(sut_.over());
  Asking limited("the end", 5, 1, 20.0, trouble_);
  step(limited);
  step(limited, 19 * kSecond);
  EXPECT_FALSE(limited.over());
  step(limited, 2 * kSecond);
  EXPECT_TRUE(limited.over());
}

TEST_F(AskingTest, InterruptionAndTheEndOfAProcessEndIt) {
  step(sut_);
  end_of_process({"display ended", false, false}, sut_);
  EXPECT_TRUE(sut_.over());
  EXPECT_FALSE(sut_.answer());
  EXPECT_EQ(trouble_.why(), "display ended");
}

}  // namespace
}  // namespace stillhand::lab::asking_test
