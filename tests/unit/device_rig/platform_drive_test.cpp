// SPDX-License-Identifier: Apache-2.0
#include "services/devices/device_rig/platform_drive.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace stillhand::device_rig::platform_drive_test {

constexpr motion::PlatformLimits kGuard{.max_position_m = 0.15,
                                        .max_velocity_m_s = 1.5,
                                        .max_acceleration_m_s2 = 15.0,
                                        .stop_acceleration_m_s2 = 5.0};

/// A platform that does what it is asked, one tick later.
class PlatformDriveTest : public testing::Test {
 protected:
  PlatformDriveTest() {
    in_.age_ticks = 1;
    in_.reply = {.whole = true, .stage = PlatformStage::kHolding, .position_m = 0.08};
    in_.wanted = {true, {}};
  }
  PlatformDrive::Output step() {
    const auto out = sut_.step(in_);
    const bool follows = out.set_point.order == PlatformOrder::kFollow;
    if (in_.reply.stage != PlatformStage::kFault) {
      in_.reply.stage = follows ? PlatformStage::kFollowing : PlatformStage::kHolding;
    }
    if (follows) in_.reply.position_m = out.set_point.position_m;
    return out;
  }
  PlatformDrive::Output steps(int ticks) {
    PlatformDrive::Output out = step();
    for (int i = 1; i < ticks; ++i) out = step();
    return out;
  }
  void engage(std::int64_t trial) {
    in_.trial = trial;
    in_.leave = MotionLeave::kEngage;
    steps(3000);
    ASSERT_EQ(sut_.stage(), SeatStage::kFollowing);
  }
  void follow(std::int64_t trial) {
    engage(trial);
    in_.leave = MotionLeave::kFollow;
    in_.measured = true;
    for (int tick = 0; tick < 700; ++tick) {
      swing(tick);
      step();
    }
    ASSERT_EQ(sut_.stage(), SeatStage::kFollowing);
  }
  // 0.08 m at 1 Hz: 0.5 m/s, 3.2 m/s^2; it begins at rest.
  void swing(int tick) {
    const double w = 2.0 * 3.14159265358979, t = 1e-3 * tick;
    in_.wanted.command = {0.08 * (1.0 - std::cos(w * t)) / 2.0, 0.04 * w * std::sin(w * t),
                          0.04 * w * w * std::cos(w * t)};
  }
  void expect_lost(SeatReason reason) {
    PlatformDrive::Output out = step();
    for (int i = 0; i < 60 && out.stage != SeatStage::kFaulted; ++i) out = step();
    EXPECT_EQ(out.stage, SeatStage::kFaulted);
    EXPECT_EQ(sut_.reason(), reason);
    EXPECT_EQ(out.set_point.order, PlatformOrder::kRelease);
    EXPECT_FALSE(sut_.engaged());
  }

  PlatformDrive sut_{{.guard = kGuard}};
  PlatformDrive::Input in_;
};

TEST_F(PlatformDriveTest, NothingMovesWithoutLeave) {
  in_.trial = 1;
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(step().set_point.order, PlatformOrder::kHold);
}

TEST_F(PlatformDriveTest, ItEngagesFromWhereItStandsAndSlowly) {
  in_.trial = 1;
  in_.leave = MotionLeave::kEngage;
  PlatformDrive::Output out = step();
  for (int i = 0; i < 200 && out.set_point.order != PlatformOrder::kFollow; ++i) out = step();
  ASSERT_EQ(out.set_point.order, PlatformOrder::kFollow);
  EXPECT_EQ(out.set_point.position_m, 0.08);
  bool began = false;
  for (int i = 0; i < 3000; ++i) {
    // The trial waits until it is where the trial begins.
    ASSERT_EQ(sut_.engaged(), out.stage == SeatStage::kFollowing);
    out = step();
    began |= out.began;
    ASSERT_LE(std::abs(out.set_point.velocity_m_s), 0.12 + 1e-9);  // Eq. SG-21
    ASSERT_LE(std::abs(out.set_point.acceleration_m_s2), 0.37);
  }
  EXPECT_TRUE(began);
  EXPECT_EQ(out.stage, SeatStage::kFollowing);
  EXPECT_EQ(out.set_point.position_m, 0.0);
}

TEST_F(PlatformDriveTest, APlatformThatMovesIsNotEngaged) {
  in_.trial = 1;
  in_.leave = MotionLeave::kEngage;
  for (int i = 0; i < 1000; ++i) {
    in_.reply.position_m = 0.08 + 1e-4 * i * (i % 2 == 0 ? 1 : -1);
    const auto order = step().set_point.order;
    ASSERT_TRUE(i <= 20 || order == PlatformOrder::kHold) << i;
  }
}

TEST_F(PlatformDriveTest, APlatformThatIsNotEngagedWhenTheTrialBeginsIsLostForIt) {
  in_.trial = 1;
  in_.leave = MotionLeave::kFollow;
  expect_lost(SeatReason::kLate);
}

TEST_F(PlatformDriveTest, APlatformOutsideOfItsTravelIsNotEngaged) {
  in_.trial = 1;
  in_.reply.position_m = 0.2;
  in_.leave = MotionLeave::kEngage;
  steps(200);
  expect_lost(SeatReason::kOutside);
}

TEST_F(PlatformDriveTest, ACommandWithinTheLimitsPassesUnchanged) {
  follow(1);
  swing(700);
  const auto out = step();
  EXPECT_EQ(out.set_point.position_m, in_.wanted.command.position_m);
  EXPECT_EQ(out.set_point.velocity_m_s, in_.wanted.command.velocity_m_s);
  EXPECT_EQ(out.set_point.acceleration_m_s2, in_.wanted.command.acceleration_m_s2);
}

TEST_F(PlatformDriveTest, EveryLossInATrialIsALossForTheTrialAndAnotherOneBeginsWhereItStands) {
  struct Loss {
    SeatReason reason;
    void (*make)(PlatformDrive::Input&);
  };
  const Loss kLosses[]{
      {SeatReason::kSilent, [](auto& in) { in.age_ticks = 21; }},
      {SeatReason::kFault, [](auto& in) { in.reply.stage = PlatformStage::kFault; }},
      {SeatReason::kOff, [](auto& in) { in.reply.stage = PlatformStage::kHolding; }},
      {SeatReason::kStranger, [](auto& in) { in.stranger = true; }}};
  for (const Loss& loss : kLosses) {
    sut_ = PlatformDrive{{.guard = kGuard}};
    in_.age_ticks = 1;
    in_.stranger = in_.measured = false;
    in_.reply.stage = PlatformStage::kHolding;
    follow(1);
    loss.make(in_);
    expect_lost(loss.reason);
    // It is well again: not in this trial.
    in_.age_ticks = 1;
    in_.stranger = false;
    in_.reply.stage = PlatformStage::kHolding;
    in_.reply.position_m = -0.05;
    for (int i = 0; i < 2000; ++i) ASSERT_EQ(step().set_point.order, PlatformOrder::kRelease);
    in_.trial = 2;
    in_.leave = MotionLeave::kEngage;
    in_.measured = false;
    in_.wanted.command = {};
    PlatformDrive::Output out = step();
    for (int i = 0; i < 200 && out.set_point.order != PlatformOrder::kFollow; ++i) out = step();
    EXPECT_EQ(out.set_point.position_m, -0.05);
  }
}

TEST_F(PlatformDriveTest, WithoutLeaveItBrakesWithinItsLimitsAndHolds) {
  follow(1);
  in_.leave = MotionLeave::kHold;
  double before_m_s2 = in_.wanted.command.acceleration_m_s2;
  int ticks = 0;
  PlatformDrive::Output out = step();
  for (; out.set_point.order == PlatformOrder::kFollow && ticks < 1000; ++ticks) {
    ASSERT_LE(std::abs(out.set_point.acceleration_m_s2), 5.0 + 1e-9);
    // J dt, and the rounding of a difference of speeds over dt.
    ASSERT_LE(std::abs(out.set_point.acceleration_m_s2 - before_m_s2), 1.0 + 1e-9) << ticks;
    before_m_s2 = out.set_point.acceleration_m_s2;
    out = step();
  }
  EXPECT_EQ(out.set_point.order, PlatformOrder::kHold);
  EXPECT_EQ(out.stage, SeatStage::kStanding);
  // 0.25 m/s at 5 m/s^2 are 50 ticks; the acceleration of before, 1.3 m/s^2, and the way to 5 m/s^2
  // and back to 0 at 1 m/s^2 a tick are 10 more.
  EXPECT_LE(ticks, 65);
  EXPECT_EQ(out.flags, kInhibited);
}

TEST_F(PlatformDriveTest, APlatformThatStaysEngagedHoldsOnePlaceWhateverItReports) {
  follow(1);
  in_.leave = MotionLeave::kHold;
  steps(200);
  const double held_m = sut_.step(in_).set_point.position_m;
  for (int i = 0; i < 1000; ++i) {
    in_.reply.stage = PlatformStage::kFollowing;  // a Moog
    in_.reply.position_m = held_m - 5e-4;         // droops
    const auto out = sut_.step(in_);
    ASSERT_EQ(out.set_point.order, PlatformOrder::kHold);
    ASSERT_NEAR(out.set_point.position_m, held_m, 5e-4 + 1e-12);
  }
}

TEST_F(PlatformDriveTest, APlatformThatSomebodyMovedInASilenceIsHeldWhereItIsThen) {
  follow(1);
  in_.leave = MotionLeave::kHold;
  steps(200);
  in_.reply.stage = PlatformStage::kFollowing;  // a Moog stays engaged
  const double held_m = sut_.step(in_).set_point.position_m;
  in_.age_ticks = 5000;
  EXPECT_EQ(sut_.step(in_).set_point.position_m, held_m);
  in_.age_ticks = 1;
  in_.reply.position_m = held_m - 0.05;
  for (int i = 0; i < 10; ++i) {
    const auto out = sut_.step(in_);
    EXPECT_EQ(out.set_point.order, PlatformOrder::kHold);
    EXPECT_EQ(out.set_point.position_m, held_m - 0.05);
  }
}

}  // namespace stillhand::device_rig::platform_drive_test
