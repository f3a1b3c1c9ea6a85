// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/core/model_stages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/lab/stage_fixture.hpp"

namespace stillhand::lab::model_stages_test {
namespace {

using testing::IsEmpty;

class ModelWaitTest : public StageTest {
 protected:
  ModelWait sut_{0, trouble_};
};

TEST_F(ModelWaitTest, IsOverWithTheUsableModelOfItsTrial) {
  seen_.model = {7, true, ""};
  step(sut_);
  EXPECT_FALSE(sut_.over());
  seen_.model = {0, true, ""};
  step(sut_);
  EXPECT_EQ(failure_of(sut_), "");
}

TEST_F(ModelWaitTest, AModelThatIsNotUsableIsAFailureWithItsReason) {
  seen_.model = {0, false, "VAF 12 %"};
  step(sut_);
  EXPECT_EQ(failure_of(sut_), "no usable model, a longer --identify-seconds helps: VAF 12 %");
}

TEST_F(ModelWaitTest, AModelThatIsLateIsAFailureAfterAMinute) {
  EXPECT_EQ(failure_after(sut_, 60 * kSecond), "identification gave no model within 60 s");
}

TEST_F(ModelWaitTest, AProcessThatEndsIsTheReason) {
  end_of_process({"identification (pid 7) ended: signal 9 (Killed)", false, false}, sut_);
  EXPECT_EQ(failure_of(sut_), "identification (pid 7) ended: signal 9 (Killed)");
}

TEST_F(ModelWaitTest, AnEmergencyStopIsTheReason) {
  ask(Action::kEmergencyStop);
  step(sut_);
  EXPECT_EQ(sut_.failure(), "emergency stop, asked by desk");
}

class RecordingWaitTest : public StageTest {
 protected:
  RecordingWait sut_{500, trouble_};
};

TEST_F(RecordingWaitTest, IsOverWhenTheDiskHasTheTrialAndNotAnEarlierOne) {
  seen_.recorded_tick = 499;
  step(sut_);
  EXPECT_FALSE(sut_.over());
  seen_.recorded_tick = 550;
  step(sut_);
  EXPECT_EQ(failure_of(sut_), "");
}

TEST_F(RecordingWaitTest, ADiskThatIsTooSlowIsAFailure) {
  step(sut_);
  step(sut_, 10 * kSecond + 1);
  EXPECT_EQ(failure_of(sut_), "the recorder's disk did not have the trial within 10 s");
}

TEST_F(RecordingWaitTest, ARecorderThatEndsIsTheReason) {
  end_of_process({"recorder (pid 7) ended: exit status 1", false, false}, sut_);
  EXPECT_EQ(sut_.failure(), "recorder (pid 7) ended: exit status 1");
}

class ModelUseTest : public StageTest {
 protected:
  ModelUse sut_{trouble_};
};

TEST_F(ModelUseTest, GivesTheModelWithNoticeAndIsOverWhenItIsLoaded) {
  event(EventKind::kModelLoaded, "cancellation");  // an earlier one
  rig_at(5000);
  const Actions first = step(sut_);
  EXPECT_EQ(first.give_model_from, 5000 + kModelNotice_ticks);
  EXPECT_FALSE(step(sut_).give_model_from.has_value());
  EXPECT_FALSE(sut_.over());
  event(EventKind::kModelLoaded, "cancellation");
  step(sut_);
  EXPECT_EQ(failure_of(sut_), "");
  EXPECT_THAT(sut_.refusal(), IsEmpty());
}

TEST_F(ModelUseTest, ARefusalIsAnAnswerWithItsReason) {
  step(sut_);
  event(EventKind::kModelRefused, "cancellation", "model gain is above the bound");
  step(sut_);
  EXPECT_TRUE(sut_.over());
  EXPECT_EQ(sut_.refusal(), "model gain is above the bound");
  EXPECT_THAT(sut_.failure(), IsEmpty());
}

TEST_F(ModelUseTest, NoAnswerIsAFailureAfterFiveSeconds) {
  EXPECT_EQ(failure_after(sut_, 5 * kSecond), "the canceller did not answer within 5 s");
}

}  // namespace
}  // namespace stillhand::lab::model_stages_test
