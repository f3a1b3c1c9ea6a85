// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/fdcanusb_line.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace stillhand::device_rig::moteus::fdcanusb_line_test {

using testing::ElementsAre;

Frame printed_frame() {
  Frame frame;
  FrameWriter writer(frame);
  writer.write(Resolution::kInt8, kMode, {10});
  writer.write(Resolution::kInt16, kCommandPosition, {0.0096, 0.072, -1.76});
  writer.read(Resolution::kInt16, kMode, 4);
  writer.read(Resolution::kInt8, kVoltage, 3);
  return frame;
}

TEST(SendLineTest, IsTheLineThatTheMakerPrints) {
  EXPECT_EQ(send_line(0x8001, printed_frame(), false).view(),
            "can send 8001 01000a07206000200150ff140400130d\n");
}

// 12: by the Python routine that docs/integration/uart.md prints, over everything before the star.
TEST(SendLineTest, EndsWithTheChecksumOfTheMakersRoutine) {
  EXPECT_EQ(send_line(0x8001, printed_frame(), true).view(),
            "can send 8001 01000a07206000200150ff140400130d *12\n");
}

TEST(SendLineTest, TheLongestFrameFits) {
  const Frame frame{.size = Frame::kMost};
  EXPECT_EQ(send_line(0x8001, frame, true).view().back(), '\n');
}

TEST(ReadLineTest, ReadsTheReplyThatTheMakerPrints) {
  const auto sut = read_line("rcv 100 2404000a005000000170ff230d181400 E B F", false);
  ASSERT_EQ(sut.kind, Received::Kind::kFrame);
  EXPECT_EQ(sut.identifier, 0x100u);
  EXPECT_EQ(sut.frame.size, 16u);
  EXPECT_EQ(sut.frame.bytes[0], 0x24);
}

// BD and 19 by the maker's routine.
TEST(ReadLineTest, AChecksumIsComparedAndTakenOff) {
  EXPECT_EQ(read_line("OK *BD", true).kind, Received::Kind::kOk);
  EXPECT_EQ(read_line("rcv 100 2404000a005000000170ff230d181400 *19", true).kind,
            Received::Kind::kFrame);
  EXPECT_EQ(read_line("OK *BE", true).kind, Received::Kind::kDamaged);
  EXPECT_EQ(read_line("OK", true).kind, Received::Kind::kDamaged);
  EXPECT_EQ(read_line("OK *BE", false).kind, Received::Kind::kDamaged);
}

// Of any number of bytes, none and the 64 of CAN-FD included.
TEST(ReadLineTest, WhatIsNoPayloadIsDamaged) {
  for (const std::size_t size : {0u, 1u, 64u}) {
    const auto sut = read_line("rcv 100 " + std::string(2 * size, '7'), false);
    EXPECT_EQ(sut.kind, Received::Kind::kFrame) << size;
    EXPECT_EQ(sut.frame.size, size);
    for (const std::uint8_t each : sut.frame.payload()) EXPECT_EQ(each, 0x77);
  }
  for (const char* line : {"rcv", "rcv xyz 00", "rcv 100 0", "rcv 100 0g", "rcv 100 770g"}) {
    EXPECT_EQ(read_line(line, false).kind, Received::Kind::kDamaged) << line;
  }
  const std::string too_long = "rcv 100 " + std::string(130, '0');
  EXPECT_EQ(read_line(too_long, false).kind, Received::Kind::kDamaged);
  EXPECT_EQ(read_line("ERR unknown", false).kind, Received::Kind::kError);
  EXPECT_EQ(read_line("\x01\x02garbage", false).kind, Received::Kind::kOther);
}

TEST(LineSplitterTest, JoinsPiecesAndDropsALineWithoutAnEnd) {
  LineSplitter sut;
  std::vector<std::string> lines;
  const auto take = [&](std::string_view text) {
    sut.take(text, [&](std::string_view line) { lines.emplace_back(line); });
  };
  take("O");
  take("K\r\n\nrcv ");
  take("1\n");
  take(std::string(1000, 'x'));
  take("\nOK\n");
  EXPECT_THAT(lines, ElementsAre("OK", "rcv 1", "OK"));
}

}  // namespace stillhand::device_rig::moteus::fdcanusb_line_test
