// SPDX-License-Identifier: Apache-2.0
// Eq. DR-35: a joystick's records.  No joystick was tried: a machine without /dev/uinput has none
// to stand in.
#include "services/core/device_rig/joystick_protocol.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/core/device_rig/joystick_record.hpp"
#include "services/devices/device_rig/joystick_port.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::device_rig {
namespace {

class JoystickProtocolTest : public testing::Test, protected DriveListener {
 protected:
  static DriveConfig config() {
    DriveConfig config;
    config.max_torque_n_m = 2.0;
    config.watchdog_s = 0.05;
    config.gain = 0.25;
    return config;
  }
  ForceRecord order(Order order, double torque_n_m = 0.0) {
    return record_in<ForceRecord>(sut_.order(order, torque_n_m)).value_or(ForceRecord{});
  }
  std::optional<DriveReply> take(const StickRecord& record) {
    reply_.reset();
    sut_.take({reinterpret_cast<const char*>(&record), sizeof(record)}, *this);
    return reply_;
  }

  JoystickProtocol sut_{config(), {.travel_rev = 0.08}};
  int damaged_ = 0;

 private:
  void state(const DriveReply& reply) noexcept override { reply_ = reply; }
  void damaged() noexcept override { ++damaged_; }
  std::optional<DriveReply> reply_;
};

TEST_F(JoystickProtocolTest, EveryForceHasALengthAndABound) {
  const ForceRecord half = order(Order::kTorque, 1.0);
  EXPECT_EQ(half.kind, ForceRecord::kPlay);
  EXPECT_EQ(half.length_ms, 50);
  EXPECT_NEAR(half.level, 0.25 * 16384, 1);
  EXPECT_EQ(order(Order::kTorque, -50.0).level, -8192);
  EXPECT_EQ(order(Order::kTorque, std::nan("")).level, 0);
  EXPECT_EQ(order(Order::kStop).kind, ForceRecord::kStop);
  EXPECT_EQ(order(Order::kQuery).kind, ForceRecord::kAsk);
}

TEST_F(JoystickProtocolTest, ItsEndsAreTheStops) {
  const auto reply = take({.value = 255, .lowest = 0, .highest = 255, .milliseconds = 70000});
  ASSERT_TRUE(reply);
  EXPECT_DOUBLE_EQ(reply->position_rev, 0.08);
  EXPECT_EQ(reply->milliseconds, 70000 - 65536);
  EXPECT_DOUBLE_EQ(take({.value = 0, .lowest = 0, .highest = 255})->position_rev, -0.08);
  EXPECT_DOUBLE_EQ(take({.value = 0, .lowest = -32768, .highest = 32768})->position_rev, 0.0);
  EXPECT_FALSE(take({.value = 0, .lowest = 0, .highest = 0}));
  EXPECT_EQ(damaged_, 1);
}

TEST_F(JoystickProtocolTest, AForceThatRanOutOrWasRefusedIsNoForce) {
  const auto mode = [&](std::uint32_t each) {
    return take({.value = 0, .lowest = -1, .highest = 1, .mode = each})->mode;
  };
  EXPECT_EQ(mode(StickRecord::kOff), DriveMode::kOff);
  EXPECT_EQ(mode(StickRecord::kPlays), DriveMode::kTorque);
  EXPECT_EQ(mode(StickRecord::kRanOut), DriveMode::kTimedOut);
  EXPECT_EQ(mode(StickRecord::kRefused), DriveMode::kFault);
  EXPECT_EQ(mode(99), DriveMode::kFault);
}

TEST(ForceLatchTest, AForceThatRanOutStaysAwayUntilAStop) {
  constexpr std::int64_t kMs_ns = 1'000'000;
  ForceLatch sut;
  EXPECT_TRUE(sut.play(0, 50));
  EXPECT_TRUE(sut.play(40 * kMs_ns, 50));
  EXPECT_FALSE(sut.ran_out(90 * kMs_ns));
  EXPECT_TRUE(sut.ran_out(91 * kMs_ns));
  EXPECT_FALSE(sut.play(92 * kMs_ns, 50));
  EXPECT_FALSE(sut.plays());
  sut.stop();
  EXPECT_TRUE(sut.play(93 * kMs_ns, 50));
  EXPECT_TRUE(sut.plays());
}

TEST(JoystickPortTest, WhatIsNoJoystickIsRefused) {
  const auto refusal = [](const char* path) {
    return support::refusal([&] { const JoystickPort sut(path); });
  };
  EXPECT_THAT(refusal("/dev/null"), testing::HasSubstr("no joystick that plays constant forces"));
  EXPECT_THAT(refusal("/nowhere"), testing::HasSubstr("No such file"));
}

}  // namespace
}  // namespace stillhand::device_rig
