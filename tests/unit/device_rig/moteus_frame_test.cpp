// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/moteus_frame.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "services/core/device_rig/moteus_drive.hpp"
#include "tests/support/hex.hpp"

namespace stillhand::device_rig::moteus::moteus_frame_test {

// The exchange that the maker prints: mjbots/moteus, docs/protocol/can.md, "Example".
TEST(FrameWriterTest, MakesTheFrameThatTheMakerPrints) {
  Frame frame;
  FrameWriter sut(frame);
  sut.write(Resolution::kInt8, kMode, {10});
  sut.write(Resolution::kInt16, kCommandPosition, {3.456 / 360.0, 25.92 / 360.0, -1.76});
  sut.read(Resolution::kInt16, kMode, 4);
  sut.read(Resolution::kInt8, kVoltage, 3);
  sut.pad();
  EXPECT_TRUE(sut.good());
  EXPECT_EQ(hex(frame.payload()), "01000a07206000200150ff140400130d");
}

// The maker's reply; its text says what each value is.  Tolerance: half a step of an int16.
TEST(FrameReaderTest, ReadsTheReplyThatTheMakerPrints) {
  const auto payload = bytes("2404000a005000000170ff230d181400");
  const DriveReply reply = read_reply(payload);
  EXPECT_TRUE(reply.whole);
  EXPECT_EQ(reply.mode, DriveMode::kTorque);
  EXPECT_NEAR(reply.position_rev * 360.0, 2.88, 0.018);
  EXPECT_NEAR(reply.velocity_rev_s * 360.0, 23.04, 0.045);
  EXPECT_NEAR(reply.torque_n_m, -1.44, 0.005);
  EXPECT_NEAR(reply.voltage_v, 12.0, 0.25);
  EXPECT_NEAR(reply.temperature_c, 20.0, 0.5);
  EXPECT_EQ(reply.fault, 0);
  EXPECT_FALSE(reply.refused);
  // Behind it comes what no document knows.
  EXPECT_FALSE(read_reply(bytes("2404000a005000000170ff230d18140060")).whole);
}

// The same reply, its mode and its fault as floats.
TEST(FrameReaderTest, AModeOrFaultThatIsNoNumberMakesNoWholeReply) {
  const auto reply_with = [](const std::string& mode, const std::string& fault) {
    return read_reply(bytes("2d00" + mode + "27015000000170ff220d18142d0f" + fault));
  };
  const std::string ten = "00002041";
  const std::string none = "00000000";
  EXPECT_TRUE(reply_with(ten, none).whole);
  EXPECT_EQ(reply_with(ten, none).mode, DriveMode::kTorque);
  for (const std::string wrong : {"0000c07f", "0000807f", "000080ff", "0000004f"}) {  // NaN to 2^31
    EXPECT_FALSE(reply_with(wrong, none).whole) << wrong;
    EXPECT_FALSE(reply_with(ten, wrong).whole) << wrong;
  }
}

TEST(FrameWriterTest, NotANumberIsTheMostNegativeInteger) {
  Frame frame;
  FrameWriter sut(frame);
  sut.write(Resolution::kInt16, kCommandPosition, {std::nan("")});
  EXPECT_EQ(hex(frame.payload()), "05200080");
}

TEST(FrameWriterTest, WhatIsTooLargeForItsTypeIsTheLargestOfTheType) {
  Frame frame;
  FrameWriter sut(frame);
  sut.write(Resolution::kInt16, kCommandTorque, {1e9, -1e9});
  EXPECT_EQ(hex(frame.payload()), "0622ff7f0180");
}

TEST(FrameWriterTest, PadsToALengthOfCanFd) {
  for (const auto& [from, to] : std::vector<std::pair<std::size_t, std::size_t>>{
           {3, 3}, {9, 12}, {13, 16}, {17, 20}, {21, 24}, {25, 32}, {33, 48}, {49, 64}}) {
    Frame frame;
    FrameWriter sut(frame);
    sut.to_console(std::string(from - 3, 'x'));  // behind three bytes
    sut.pad();
    EXPECT_EQ(frame.size, to);
    for (std::size_t at = from; at < to; ++at) EXPECT_EQ(frame.bytes[at], 0x50);
  }
}

TEST(FrameWriterTest, AFrameThatIsFullSaysSo) {
  Frame frame;
  FrameWriter sut(frame);
  sut.to_console(std::string(80, 'x'));
  EXPECT_FALSE(sut.good());
  EXPECT_EQ(frame.size, Frame::kMost);
}

TEST(FrameReaderTest, EveryCutOfAReplyIsUnsoundOrShorter) {
  const auto payload = bytes("2404000a005000000170ff230d181400");
  for (std::size_t size = 0; size < payload.size(); ++size) {
    const DriveReply reply = read_reply(std::span(payload).first(size));
    EXPECT_FALSE(reply.whole) << size;
  }
}

TEST(FrameReaderTest, EveryByteChangedIsReadWithoutHarm) {
  const auto good = bytes("2404000a005000000170ff230d181400");
  for (std::size_t at = 0; at < good.size(); ++at) {
    for (unsigned value = 0; value < 256; ++value) {
      auto payload = good;
      payload[at] = static_cast<std::uint8_t>(value);
      FrameReader sut(payload);
      int items = 0;
      while (sut.next() && items < 100) ++items;
      EXPECT_LT(items, 100);
    }
  }
}

TEST(FrameReaderTest, AnErrorOfARegisterIsAnItem) {
  const auto payload = bytes("316001");
  FrameReader sut(payload);
  const auto item = sut.next();
  ASSERT_TRUE(item);
  EXPECT_EQ(item->kind, FrameReader::Kind::kReadError);
  EXPECT_EQ(item->address, 0x60u);
  EXPECT_TRUE(read_reply(payload).refused);
  EXPECT_TRUE(read_reply(bytes("306001")).refused) << "of a write";
}

// mjbots/moteus, docs/protocol/registers.md, the mappings: int8, int16, int32.
TEST(StepOfTest, IsTheOneOfTheDocument) {
  const std::pair<std::uint32_t, std::array<double, 3>> cases[]{
      {kPosition, {0.01, 0.0001, 0.00001}},
      {kVelocity, {0.1, 0.00025, 0.00001}},
      {kTorque, {0.5, 0.01, 0.001}},
      {kVoltage, {0.5, 0.1, 0.001}},
      {kTemperature, {1.0, 0.1, 0.001}},
      {kCommandTimeout, {0.01, 0.001, 0.000001}},
      {kAnalog1, {1.0 / 127, 1.0 / 32767, 1.0 / 2147483647}},
      {kMode, {1.0, 1.0, 1.0}}};
  for (const auto& [address, steps] : cases) {
    for (std::uint8_t i = 0; i < 3; ++i) {
      EXPECT_DOUBLE_EQ(step_of(address, static_cast<Resolution>(i)), steps[i]) << address;
    }
    EXPECT_EQ(step_of(address, Resolution::kFloat), 1.0) << address;
  }
  EXPECT_TRUE(has_nan(kPosition));
  EXPECT_TRUE(has_nan(kTemperature)) << "its step is 1 degC in one byte alone";
  for (const auto plain : {kMode, kFault, kMilliseconds}) EXPECT_FALSE(has_nan(plain));
}

}  // namespace stillhand::device_rig::moteus::moteus_frame_test
