// SPDX-License-Identifier: Apache-2.0
// Eq. DR-34.  Judges: the frames that the maker of moteus prints (mjbots/moteus,
// docs/protocol/can.md), and the kernel's own struct canfd_frame.
#include "services/core/device_rig/can_record.hpp"

#include <gtest/gtest.h>
#include <linux/can.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "services/core/device_rig/moteus_drive.hpp"

namespace stillhand::device_rig::moteus::can_record_test {

Frame frame_of(const std::vector<std::uint8_t>& bytes) {
  Frame frame;
  std::ranges::copy(bytes, frame.bytes.begin());
  frame.size = bytes.size();
  return frame;
}

canfd_frame kernels(const CanRecord& record) {
  canfd_frame frame{};
  std::memcpy(&frame, record.bytes.data(), sizeof(frame));
  return frame;
}

// "can send 8001 01000a07206000200150ff140400130d"
const std::vector<std::uint8_t> kCommand{0x01, 0x00, 0x0a, 0x07, 0x20, 0x60, 0x00, 0x20,
                                         0x01, 0x50, 0xff, 0x14, 0x04, 0x00, 0x13, 0x0d};
// "rcv 100 2404000a005000000170ff230d181400"
const std::vector<std::uint8_t> kReply{0x24, 0x04, 0x00, 0x0a, 0x00, 0x50, 0x00, 0x00,
                                       0x01, 0x70, 0xff, 0x23, 0x0d, 0x18, 0x14, 0x00};

TEST(CanRecordTest, TheMakersPrintedCommandIsTheKernelsFrame) {
  ASSERT_EQ(CanRecord::kSize, sizeof(canfd_frame));
  const canfd_frame sut = kernels(record_of(0x8001, frame_of(kCommand)));
  EXPECT_EQ(sut.can_id, 0x8001u | CAN_EFF_FLAG);
  EXPECT_EQ(sut.len, 16);
  EXPECT_EQ(sut.flags, CANFD_BRS);
  EXPECT_TRUE(std::equal(kCommand.begin(), kCommand.end(), sut.data));
  EXPECT_EQ(sut.data[16], 0);
}

TEST(CanRecordTest, TheMakersPrintedReplyIsRead) {
  canfd_frame frame{};
  frame.can_id = 0x100;
  frame.len = 16;
  std::copy(kReply.begin(), kReply.end(), frame.data);
  const auto sut = read_record({reinterpret_cast<const char*>(&frame), sizeof(frame)});
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->identifier, 0x100u);
  const DriveReply reply = read_reply(sut->frame.payload());
  EXPECT_TRUE(reply.whole);
  EXPECT_EQ(reply.mode, DriveMode::kTorque);
  EXPECT_NEAR(reply.torque_n_m, -1.44, 1e-9);
  EXPECT_NEAR(360.0 * reply.position_rev, 2.88, 1e-9);
}

// "The CAN frame must be an extended one if the ID would be greater than 0x7fff, but otherwise
// whether or not a frame is extended is not considered."  11 bits are what a standard one holds.
TEST(CanRecordTest, AnIdentifierThatNeedsMoreThanElevenBitsIsExtended) {
  EXPECT_EQ(kernels(record_of(0x7ff, {})).can_id, 0x7ffu);
  EXPECT_EQ(kernels(record_of(0x800, {})).can_id, 0x800u | CAN_EFF_FLAG);
  canfd_frame frame{};
  frame.can_id = 0x100 | CAN_EFF_FLAG;
  const auto sut = read_record({reinterpret_cast<const char*>(&frame), sizeof(frame)});
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->identifier, 0x100u);
}

TEST(CanRecordTest, WhatIsNoFrameOfTheBusIsNone) {
  canfd_frame frame{};
  const auto read = [&] {
    return read_record({reinterpret_cast<const char*>(&frame), sizeof(frame)}).has_value();
  };
  EXPECT_TRUE(read());
  frame.can_id = 0x100 | CAN_ERR_FLAG;
  EXPECT_FALSE(read());
  frame.can_id = 0x100 | CAN_RTR_FLAG;
  EXPECT_FALSE(read());
  frame.can_id = 0x100;
  frame.len = 65;
  EXPECT_FALSE(read());
  for (const std::size_t size : {0u, 8u, 15u, 71u}) {
    EXPECT_FALSE(read_record({reinterpret_cast<const char*>(&frame), size})) << size;
  }
  can_frame classic{};
  classic.can_id = 0x100;
  classic.len = 8;
  EXPECT_TRUE(read_record({reinterpret_cast<const char*>(&classic), sizeof(classic)}));
}

}  // namespace stillhand::device_rig::moteus::can_record_test
