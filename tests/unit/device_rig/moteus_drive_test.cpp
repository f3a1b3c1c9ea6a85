// SPDX-License-Identifier: Apache-2.0
// The rules of a torque command, judged by the emulator, which is written from the maker's
// documents and shares no code with the driver.
#include "services/core/device_rig/moteus_drive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "services/core/device_rig/fdcanusb_line.hpp"
#include "tests/emulators/moteus_emulator.hpp"
#include "tests/support/hex.hpp"

namespace stillhand::device_rig::moteus::moteus_drive_test {

constexpr std::int64_t kMs_ns = 1'000'000;

class TorqueFrameTest : public testing::Test {
 protected:
  DriveReply exchange(const Frame& frame) {
    const std::string answers = drive_.take(send_line(0x8001, frame, false).view(), now_ns_);
    DriveReply reply;
    LineSplitter splitter;
    splitter.take(answers, [&](std::string_view line) {
      const auto received = read_line(line, false);
      if (received.kind == Received::Kind::kFrame) reply = read_reply(received.frame.payload());
    });
    return reply;
  }
  DriveReply command(double torque_n_m, double most_n_m = 2.0) {
    return exchange(
        torque_frame({.torque_n_m = torque_n_m, .max_torque_n_m = most_n_m, .watchdog_s = 0.02}));
  }
  void wait_ms(int count) {
    for (int i = 0; i < count; ++i) drive_.tick(now_ns_ += kMs_ns);
  }

  std::int64_t now_ns_ = kMs_ns;
  emulators::MoteusEmulator drive_{false};
};

TEST_F(TorqueFrameTest, IsThatTorqueWhereverTheStickIsAndHoweverItMoves) {
  drive_.sense({.position_rev = 0.07, .velocity_rev_s = -1.5});
  const DriveReply reply = command(0.8);
  EXPECT_TRUE(reply.whole);
  EXPECT_EQ(reply.mode, DriveMode::kTorque);
  // A float carries 0.8 with a relative error below 2^-24.
  EXPECT_NEAR(drive_.torque_n_m(), 0.8, 1e-7);
  drive_.sense({.position_rev = -0.05, .velocity_rev_s = 2.0});
  wait_ms(1);
  EXPECT_NEAR(drive_.torque_n_m(), 0.8, 1e-7);
  EXPECT_EQ(drive_.record().with_gains, 0u);
  EXPECT_EQ(drive_.record().without_bound, 0u);
  EXPECT_EQ(drive_.record().without_watchdog, 0u);
}

// Written out by hand from can.md: 0x18 | 3, register 0x120 as a varuint; least significant word
// first, and every bit of a word counts.
TEST(SerialFrameTest, IsThePacketOfTheDocument) {
  EXPECT_EQ(hex(serial_frame().payload()), "1ba002");
  const std::vector<std::uint8_t> reply{0x2b, 0xa0, 0x02, 0x3a, 0x00, 0x1d, 0x00, 0x30,
                                        0x50, 0x00, 0x00, 0x00, 0x00, 0x00, 0x80};
  EXPECT_EQ(read_serial(reply), (SerialNumber{0x1d003a, 0x5030, 0x80000000}));
  const std::vector<std::uint8_t> cut(reply.begin(), reply.end() - 4);
  EXPECT_FALSE(read_serial(cut));
  EXPECT_FALSE(read_serial(std::vector<std::uint8_t>{0x31, 0xa0, 0x02, 0x01}));
  EXPECT_FALSE(read_serial(bytes("2804a002" + std::string(32, '0')))) << "four words";
}

TEST_F(TorqueFrameTest, IsBoundedHereAndAtTheDrive) {
  command(50.0);
  EXPECT_DOUBLE_EQ(drive_.torque_n_m(), 2.0);
  command(std::nan(""));
  EXPECT_EQ(drive_.torque_n_m(), 0.0);
  command(-std::numeric_limits<double>::infinity());
  EXPECT_EQ(drive_.torque_n_m(), 0.0);
  for (const double most_n_m : {0.5, 0.0, -1.0, std::nan("")}) {
    command(50.0, most_n_m);
    EXPECT_EQ(drive_.torque_n_m(), most_n_m > 0.0 ? most_n_m : 0.0) << most_n_m;
  }
}

// By hand from can.md: mode 10; position NaN, velocity 0; torque 1; kp, kd 0; largest torque 2;
// 0.02 s; integral 0; what is read: mode, position to torque, voltage to fault, inputs, counter.
TEST_F(TorqueFrameTest, HasTheBytesOfTheDocument) {
  const std::string query = "11001b01130d156015681570";
  EXPECT_EQ(hex(query_frame().payload()), query);
  EXPECT_EQ(hex(stop_frame().payload()), "010000" + query + "50");
  EXPECT_EQ(
      hex(torque_frame({1.0, 2.0, 0.02}).payload()),
      "01000a0620008000000d220000803f022300000d25000000400d270ad7a33c012b00" + query + "5050");
}

TEST_F(TorqueFrameTest, EndsWithTheWatchdogAndLatchesUntilAStop) {
  command(0.8);
  wait_ms(19);
  EXPECT_GT(drive_.torque_n_m(), 0.0);
  wait_ms(2);
  EXPECT_EQ(drive_.torque_n_m(), 0.0);
  EXPECT_EQ(command(0.8).mode, DriveMode::kTimedOut);
  EXPECT_EQ(drive_.torque_n_m(), 0.0);
  EXPECT_EQ(exchange(stop_frame()).mode, DriveMode::kOff);
  EXPECT_EQ(command(0.8).mode, DriveMode::kTorque);
}

TEST_F(TorqueFrameTest, AQueryDoesNotFeedTheWatchdog) {
  command(0.8);
  for (int i = 0; i < 25; ++i) {
    wait_ms(1);
    exchange(query_frame());
  }
  EXPECT_EQ(drive_.torque_n_m(), 0.0);
  EXPECT_EQ(drive_.record().timeouts, 1u);
}

// Trap 3 of the drive: its shipped setting damps after a timeout, with up to 5 N m.
TEST_F(TorqueFrameTest, ADriveWithTheShippedTimeoutModeStillPushes) {
  drive_.set("servo.timeout_mode", "12");
  drive_.sense({.velocity_rev_s = 1.0});
  command(0.8);
  wait_ms(30);
  EXPECT_LT(drive_.torque_n_m(), -0.1);
}

TEST_F(TorqueFrameTest, TheReplyHoldsTheAnalogueInputs) {
  drive_.sense({.position_rev = 0.01, .analog1 = 0.25, .analog2 = 0.75});
  const DriveReply reply = exchange(query_frame());
  // A converter of 12 bit, then an int16.
  EXPECT_NEAR(reply.analog1, 0.25, 0.5 / 4095 + 0.5 / 32767);
  EXPECT_NEAR(reply.analog2, 0.75, 0.5 / 4095 + 0.5 / 32767);
  EXPECT_NEAR(reply.position_rev, 0.01, 0.5e-5);
}

TEST_F(TorqueFrameTest, AFirmwareWithoutARegisterIsSeen) {
  drive_.forget(0x03);
  const DriveReply reply = exchange(query_frame());
  EXPECT_TRUE(reply.refused);
  EXPECT_FALSE(reply.whole);
}

TEST_F(TorqueFrameTest, APositionWithoutAValueIsNoWholeReply) {
  drive_.lose_position(true);
  EXPECT_FALSE(exchange(query_frame()).whole);
}

// The maker's printed command, given to the emulator: what it asks for is answered in that form.
// The torque is -1.76 N m and 0.003 N m of the emulator's gains, in steps of 0.01 N m.
TEST_F(TorqueFrameTest, TheEmulatorTakesTheMakersPrintedCommand) {
  drive_.sense({.position_rev = 0.008, .velocity_rev_s = 0.064});
  const std::string answers =
      drive_.take("can send 8001 01000a07206000200150ff140400130d\n", now_ns_);
  EXPECT_EQ(answers.substr(0, 4 + 24 + 6),
            "OK\r\nrcv 100 2404000A0050000001"
            "50FF");
  EXPECT_EQ(drive_.mode(), 10);
}

}  // namespace stillhand::device_rig::moteus::moteus_drive_test
