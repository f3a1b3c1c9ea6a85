// SPDX-License-Identifier: Apache-2.0
#include "apps/record/record_output.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stillhand::record::record_output_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class RequiredTopicsTest : public testing::Test {
 protected:
  /// What one step prints.
  std::string step(const std::set<std::string>& heard, std::int64_t trial = -1) {
    testing::internal::CaptureStderr();
    sut_.step(heard, trial);
    return testing::internal::GetCapturedStderr();
  }

  const std::vector<std::string> required_{"b", "a", "c"};
  RequiredTopics sut_{required_};
};

TEST_F(RequiredTopicsTest, SilentTopicsAreNamedOnceInTheOrderOfTheCommandLine) {
  EXPECT_THAT(step({"a", "x"}), AllOf(HasSubstr("b, c"), Not(HasSubstr("a,"))));
  EXPECT_EQ(sut_.missing(), "b, c");
  EXPECT_THAT(step({"a", "x"}), IsEmpty());
  EXPECT_EQ(sut_.missing(), "b, c");
}

TEST_F(RequiredTopicsTest, AChangeOfTheSilentTopicsIsNamedAgain) {
  step({"a"});
  EXPECT_THAT(step({"a", "b"}), HasSubstr(" c"));
  EXPECT_THAT(step({"a", "b", "c"}), Not(IsEmpty()));  // all are there: said once
  EXPECT_THAT(sut_.missing(), IsEmpty());
  EXPECT_THAT(step({"a", "b", "c"}), IsEmpty());
  EXPECT_THAT(step({"a"}), HasSubstr("b, c"));
}

TEST_F(RequiredTopicsTest, EachTrialThatBeginsWithoutATopicIsNamed) {
  EXPECT_THAT(step({"a", "b"}), HasSubstr("c"));
  EXPECT_THAT(step({"a", "b"}, 0), AllOf(HasSubstr("trial 0"), HasSubstr("c")));
  EXPECT_THAT(step({"a", "b"}, 0), IsEmpty());
  EXPECT_THAT(step({"a", "b"}, 1), AllOf(HasSubstr("trial 1"), HasSubstr("c")));
  EXPECT_THAT(step({"a", "b"}, -1), IsEmpty());
  EXPECT_THAT(step({"a", "b", "c"}, 2), Not(HasSubstr("trial")));
}

TEST_F(RequiredTopicsTest, WhereEveryTopicIsHeardFromTheStartNothingIsPrinted) {
  EXPECT_THAT(step({"a", "b", "c", "d"}), IsEmpty());
  EXPECT_THAT(step({"a", "b", "c", "d"}, 5), IsEmpty());
}

TEST_F(RequiredTopicsTest, WhereNoneIsRequiredNothingIsEverMissing) {
  const std::vector<std::string> none;
  RequiredTopics sut(none);
  testing::internal::CaptureStderr();
  sut.step({}, 3);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), IsEmpty());
  EXPECT_THAT(sut.missing(), IsEmpty());
}

// A pipe or a file gets the words alone: no colour and no line that is written over.
TEST(WarnTest, AFileGetsOnePlainLine) {
  testing::internal::CaptureStderr();
  warn("3 messages were lost");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "3 messages were lost\n");
}

TEST(PrintProgressTest, AFileGetsNothing) {
  recording::TapeStatus tape;
  tape.written = 12;
  testing::internal::CaptureStderr();
  print_progress(tape, 1, 2'000'000'000);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), IsEmpty());
}

}  // namespace
}  // namespace stillhand::record::record_output_test
