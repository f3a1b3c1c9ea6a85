// SPDX-License-Identifier: Apache-2.0
// Eq. DR-32: the driver's language next to the emulator, which is written from the maker's document
// and shares no code with it.
#include "services/core/device_rig/odrive_protocol.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "tests/emulators/odrive_emulator.hpp"

namespace stillhand::device_rig::odrive {
namespace {

constexpr std::int64_t kMs_ns = 1'000'000;
constexpr double kStep_n_m = 1e-6;  // six decimals of a command

DriveConfig config() {
  DriveConfig config;
  config.kind = "odrive";
  config.max_torque_n_m = 2.0;
  return config;
}

class OdriveProtocolTest : public testing::Test, protected DriveListener {
 protected:
  OdriveProtocolTest() { drive_.begin(now_ns_); }

  /// The newest state after an order.
  std::optional<DriveReply> exchange(Order order, double torque_n_m = 0.0) {
    reply_.reset();
    sut_.take(drive_.take(sut_.order(order, torque_n_m), now_ns_), *this);
    return reply_;
  }
  DriveMode mode_after(Order order, double torque_n_m = 0.0) {
    const auto reply = exchange(order, torque_n_m);
    EXPECT_TRUE(reply);
    return reply ? reply->mode : DriveMode::kOther;
  }
  void wait_ms(int count) {
    for (int i = 0; i < count; ++i) drive_.tick(now_ns_ += kMs_ns);
  }
  std::optional<std::string> setting(std::string_view name) {
    sut_.take(drive_.take(sut_.ask(name), now_ns_), *this);
    return sut_.answer();
  }
  void arm() {
    exchange(Order::kStop);
    exchange(Order::kTorque);
    ASSERT_EQ(mode_after(Order::kTorque), DriveMode::kTorque);
  }

  std::int64_t now_ns_ = kMs_ns;
  emulators::OdriveEmulator drive_;
  OdriveProtocol sut_{config(), {}};
  int damaged_ = 0;

 private:
  void state(const DriveReply& reply) noexcept override { reply_ = reply; }
  void damaged() noexcept override { ++damaged_; }

  std::optional<DriveReply> reply_;
};

TEST_F(OdriveProtocolTest, IsThatTorqueWhereverTheStickIsAndHoweverItMoves) {
  drive_.sense({.position_rev = 0.07, .velocity_rev_s = -1.5});
  arm();
  const auto reply = exchange(Order::kTorque, 0.8);
  ASSERT_TRUE(reply);
  EXPECT_NEAR(reply->position_rev, 0.07, kStep_n_m);
  EXPECT_NEAR(reply->velocity_rev_s, -1.5, kStep_n_m);
  EXPECT_NEAR(drive_.torque_n_m(), 0.8, kStep_n_m);
  drive_.sense({.position_rev = -0.05, .velocity_rev_s = 3.0});
  wait_ms(1);
  EXPECT_NEAR(drive_.torque_n_m(), 0.8, kStep_n_m);
  EXPECT_EQ(drive_.record().with_gains, 0u);
  EXPECT_EQ(drive_.record().other_modes, 0u);
  EXPECT_EQ(damaged_, 0);
}

TEST_F(OdriveProtocolTest, ArmsWithZeroTorqueEvenIfAnotherOneIsLeftInTheDrive) {
  drive_.take("c 0 1.5\n", now_ns_);
  exchange(Order::kTorque, 1.5);
  EXPECT_EQ(drive_.record().first_torque_n_m, 0.0);
  EXPECT_EQ(drive_.torque_n_m(), 0.0);
}

TEST_F(OdriveProtocolTest, IsBoundedHere) {
  arm();
  exchange(Order::kTorque, 50.0);
  EXPECT_DOUBLE_EQ(drive_.torque_n_m(), 2.0);
  exchange(Order::kTorque, std::nan(""));
  EXPECT_EQ(drive_.torque_n_m(), 0.0);
  exchange(Order::kTorque, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(drive_.torque_n_m(), 0.0);
}

TEST_F(OdriveProtocolTest, TheWatchdogEndsATorqueAndLatchesUntilAStop) {
  arm();
  exchange(Order::kTorque, 0.8);
  wait_ms(99);
  EXPECT_GT(drive_.torque_n_m(), 0.0);
  wait_ms(3);
  EXPECT_EQ(drive_.torque_n_m(), 0.0);
  EXPECT_EQ(mode_after(Order::kTorque, 0.8), DriveMode::kTimedOut);
  EXPECT_EQ(mode_after(Order::kTorque, 0.8), DriveMode::kTimedOut);
  EXPECT_EQ(drive_.torque_n_m(), 0.0);
  EXPECT_EQ(mode_after(Order::kStop), DriveMode::kOff);
  exchange(Order::kTorque);
  EXPECT_EQ(mode_after(Order::kTorque, 0.8), DriveMode::kTorque);
}

TEST_F(OdriveProtocolTest, AQueryDoesNotFeedTheWatchdog) {
  arm();
  exchange(Order::kTorque, 0.8);
  for (int i = 0; i < 102; ++i) {
    wait_ms(1);
    exchange(Order::kQuery);
  }
  EXPECT_EQ(drive_.torque_n_m(), 0.0);
  EXPECT_EQ(drive_.record().timeouts, 1u);
}

// The watchdog of an idle axis always trips, for nothing feeds it; that is no fault.
TEST_F(OdriveProtocolTest, AnIdleAxisIsOffThoughItsWatchdogTripped) {
  wait_ms(500);
  EXPECT_EQ(mode_after(Order::kQuery), DriveMode::kOff);
  arm();
}

TEST_F(OdriveProtocolTest, AnErrorIsAFaultThatNamesItsWordAndAStopClearsIt) {
  arm();
  drive_.fault(0x40000);
  const auto reply = exchange(Order::kTorque, 0.8);
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->mode, DriveMode::kFault);
  EXPECT_EQ(reply->fault, 0x40000);
  EXPECT_STREQ(reply->fault_word, "axis0.error");
  EXPECT_EQ(mode_after(Order::kStop), DriveMode::kOff);
}

// Its position reads as 0: only the error says that it is none.
TEST_F(OdriveProtocolTest, AnEncoderThatGivesNoPositionIsAFaultWithinFourExchanges) {
  drive_.sense({.position_rev = 0.05});
  drive_.lose_position(true);
  bool fault = false;
  for (int i = 0; i < 4 && !fault; ++i) fault = mode_after(Order::kQuery) == DriveMode::kFault;
  EXPECT_TRUE(fault);
}

TEST_F(OdriveProtocolTest, SettingsAreReadBack) {
  EXPECT_EQ(setting("axis0.motor.config.current_lim"), "10.000000");
  EXPECT_EQ(setting("axis0.config.no_such"), "invalid property");
}

TEST_F(OdriveProtocolTest, OfALateAnswerNoSettingIsMade) {
  const std::string late = drive_.take("r vbus_voltage *93\n", now_ns_);
  const std::string own = drive_.take(sut_.ask("axis0.config.watchdog_timeout"), now_ns_);
  sut_.take(late + own, *this);
  EXPECT_EQ(sut_.answer(), "0.100000");
  std::string between = drive_.take(sut_.ask("axis0.config.watchdog_timeout"), now_ns_);
  between.insert(between.find('\n') + 1, late);
  sut_.take(between, *this);
  EXPECT_FALSE(sut_.answer());
}

TEST_F(OdriveProtocolTest, TheSerialNumberIsThatOfTheDrive) {
  sut_.take(drive_.take(sut_.ask_serial(), now_ns_), *this);
  EXPECT_EQ(sut_.serial(), "2071339D4B42");
}

TEST_F(OdriveProtocolTest, MeasuredTorqueIsTheCurrentTimesTheConstant) {
  setting("axis0.motor.config.torque_constant");
  arm();
  exchange(Order::kTorque, 0.8);
  std::optional<DriveReply> reply;
  for (int i = 0; i < 4; ++i) reply = exchange(Order::kTorque, 0.8);
  ASSERT_TRUE(reply);
  EXPECT_NEAR(reply->torque_n_m, 0.8, 1e-5);
}

TEST_F(OdriveProtocolTest, AGearMakesTheMotorsTorqueSmallerAndItsTurnsMore) {
  DriveConfig geared = config();
  geared.ratio = 4.0;
  sut_ = OdriveProtocol(geared, {});
  drive_.sense({.position_rev = 0.2});
  arm();
  const auto reply = exchange(Order::kTorque, 0.8);
  ASSERT_TRUE(reply);
  EXPECT_NEAR(reply->position_rev, 0.05, kStep_n_m);
  EXPECT_NEAR(drive_.torque_n_m(), 0.2, kStep_n_m);
}

// The maker's printed question is answered in the printed form.
TEST_F(OdriveProtocolTest, TheEmulatorAnswersTheMakersPrintedQuestion) {
  EXPECT_EQ(drive_.take("r vbus_voltage\n", now_ns_), "24.087744\r\n");
  EXPECT_EQ(drive_.take("r vbus_voltage *93\n", now_ns_).substr(0, 10), "24.087744*");
  EXPECT_EQ(drive_.take("r vbus_voltage *92\n", now_ns_), "");
}

}  // namespace
}  // namespace stillhand::device_rig::odrive
