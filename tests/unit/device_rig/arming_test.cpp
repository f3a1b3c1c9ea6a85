// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/arming.hpp"

#include <gtest/gtest.h>

namespace stillhand::device_rig::arming_test {

/// A drive that does what it is asked, one tick later.
class ArmingTest : public testing::Test {
 protected:
  ArmingTest() { in_.fresh = in_.checked = true; }

  Arming::Output step() {
    const auto out = sut_.step(in_);
    if (obeys_ && out.order == Order::kStop) in_.mode = DriveMode::kOff;
    if (obeys_ && out.order == Order::kTorque && in_.mode == DriveMode::kOff) {
      in_.mode = DriveMode::kTorque;
    }
    return out;
  }
  void arm(std::int64_t trial) {
    in_.trial = trial;
    in_.wanted = true;
    for (int i = 0; i < 5; ++i) step();
    ASSERT_EQ(sut_.stage(), Stage::kArmed);
  }
  void expect_faulted(Reason reason) {
    Arming::Output out{};
    for (int i = 0; i < 60 && out.stage != Stage::kFaulted; ++i) out = step();
    EXPECT_EQ(out.stage, Stage::kFaulted);
    EXPECT_EQ(out.order, Order::kStop);
    EXPECT_EQ(out.reason, reason);
    EXPECT_FALSE(out.follows);
    EXPECT_EQ(sut_.fault(), reason == Reason::kFault ? in_.fault : 0);
  }

  Arming sut_;
  Arming::Input in_;
  bool obeys_ = true;
};

TEST_F(ArmingTest, NothingArmsByItself) {
  for (int i = 0; i < 100; ++i) EXPECT_EQ(step().order, Order::kQuery);
  EXPECT_EQ(sut_.stage(), Stage::kChecked);
}

TEST_F(ArmingTest, ADriveThatIsAbsentOrUncheckedIsNotArmed) {
  in_.wanted = true;
  in_.trial = 1;
  in_.fresh = false;
  EXPECT_EQ(step().stage, Stage::kAbsent);
  in_.fresh = true;
  in_.checked = false;
  EXPECT_EQ(step().stage, Stage::kFound);
  EXPECT_EQ(step().order, Order::kQuery);
}

TEST_F(ArmingTest, ADriveThatIsNotOffIsSwitchedOffFirst) {
  in_.mode = DriveMode::kTimedOut;
  in_.wanted = true;
  EXPECT_EQ(step().order, Order::kStop);
  EXPECT_EQ(step().order, Order::kTorque);
}

TEST_F(ArmingTest, ArmsOnlyAtZeroForce) {
  in_.wanted = true;
  in_.force_zero = false;
  EXPECT_EQ(step().order, Order::kQuery);
  in_.force_zero = true;
  EXPECT_EQ(step().order, Order::kTorque);
}

TEST_F(ArmingTest, WithoutPermissionTheForceRampsDownAndThenTheDriverGoesOff) {
  arm(1);
  in_.wanted = false;
  in_.force_zero = false;
  EXPECT_EQ(step().order, Order::kTorque);
  in_.force_zero = true;
  EXPECT_EQ(step().order, Order::kStop);
  EXPECT_EQ(step().order, Order::kQuery);
  EXPECT_EQ(sut_.stage(), Stage::kChecked);
}

TEST_F(ArmingTest, NoForceBeforeTheDriveSaysThatItFollows) {
  in_.wanted = true;
  // In each trial, also behind one that was longer than the drive may take to follow.
  for (in_.trial = 1; in_.trial < 3; ++in_.trial) {
    obeys_ = false;
    for (int i = 0; i < 10; ++i) EXPECT_FALSE(step().follows);
    in_.mode = DriveMode::kTorque;
    for (int i = 0; i < 100; ++i) EXPECT_TRUE(step().follows);
    obeys_ = true;
    in_.wanted = false;
    EXPECT_EQ(step().order, Order::kStop);
    in_.wanted = true;
  }
}

TEST_F(ArmingTest, EveryTroubleOfAnArmedDriveIsAFault) {
  const auto each = [&](auto change, Reason reason) {
    sut_ = {};
    in_ = {};
    in_.fresh = in_.checked = true;
    obeys_ = true;
    arm(1);
    obeys_ = false;
    change();
    expect_faulted(reason);
  };
  each([&] { in_.fresh = false; }, Reason::kSilent);
  each([&] { in_.mode = DriveMode::kFault, in_.fault = 38; }, Reason::kFault);
  each([&] { in_.mode = DriveMode::kTimedOut; }, Reason::kTimedOut);
  each([&] { in_.jumped = true; }, Reason::kEncoder);
  each([&] { in_.mode = DriveMode::kOff; }, Reason::kOff);
  each([&] { in_.checked = false; }, Reason::kUnchecked);
  each([&] { in_.mode = DriveMode::kOther; }, Reason::kOtherMode);
}

TEST_F(ArmingTest, ADriveThatDoesNotFollowIsFaulted) {
  obeys_ = false;
  in_.wanted = true;
  in_.trial = 1;
  expect_faulted(Reason::kNotArmed);
}

TEST_F(ArmingTest, AfterAFaultTheDriveIsArmedInAnotherTrialAlone) {
  arm(1);
  in_.fresh = false;
  expect_faulted(Reason::kSilent);
  in_.fresh = true;
  for (int i = 0; i < 200; ++i) EXPECT_NE(step().order, Order::kTorque);
  in_.trial = 2;
  step();
  EXPECT_EQ(step().order, Order::kTorque);
  EXPECT_EQ(sut_.reason(), Reason::kNone);
}

TEST_F(ArmingTest, AFaultThatStaysIsNotArmedInAnotherTrial) {
  arm(1);
  obeys_ = false;
  in_.mode = DriveMode::kFault;
  expect_faulted(Reason::kFault);
  in_.trial = 2;
  for (int i = 0; i < 200; ++i) EXPECT_EQ(step().order, Order::kStop);
}

}  // namespace stillhand::device_rig::arming_test
