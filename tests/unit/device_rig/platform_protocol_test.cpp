// SPDX-License-Identifier: Apache-2.0
// The packets below were written out from the documents by a Python script of struct.pack() calls,
// not by this code.
#include "services/core/device_rig/platform_protocol.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/emulators/platform_emulator.hpp"
#include "tests/support/hex.hpp"

namespace stillhand::device_rig::platform_protocol_test {

constexpr const char* kPlainCommand =
    "534850430200010007000000cdab3412140000009a9999999999a93f000000000000d0bf000000000000f83f"
    "87cfb09d";
constexpr const char* kPlainState =
    "53485053020002000900000007000000cdab34127b14ae47e17aa43f9a9999999999c9bf000000000000f43f"
    "000000001a709752";
// A position of NaN and of infinity, a velocity of NaN and of -infinity, an acceleration of
// infinity; a command's magic, version 3 and stage 4; each with its own checksum.
constexpr const char* kPlainSenseless[]{
    "53485053020002000900000007000000cdab3412000000000000f87f00000000000000000000000000000000"
    "0000000064e9a108",
    "53485053020002000900000007000000cdab3412000000000000f07f00000000000000000000000000000000"
    "0000000064cfe2b1",
    "53485053020002000900000007000000cdab34120000000000000000000000000000f87f0000000000000000"
    "00000000256b30b6",
    "53485053020002000900000007000000cdab34120000000000000000000000000000f0ff0000000000000000"
    "0000000004500325",
    "53485053020002000900000007000000cdab341200000000000000000000000000000000000000000000f07f"
    "0000000002eee11f",
    "53485043020002000900000007000000cdab34127b14ae47e17aa43f9a9999999999c9bf000000000000f43f"
    "0000000054d35b6b",
    "53485053030002000900000007000000cdab34127b14ae47e17aa43f9a9999999999c9bf000000000000f43f"
    "000000007848bf78",
    "53485053020004000900000007000000cdab34127b14ae47e17aa43f9a9999999999c9bf000000000000f43f"
    "00000000fc66e022"};
// The state 3 with fault bits 5.
constexpr const char* kPlainUnmeasured =
    "53485053020003000900000007000000cdab34127b14ae47e17aa43f0000000000000000000000000000f87f"
    "0500000009821a23";
constexpr std::uint32_t kToken = 0x1234abcd;
constexpr const char* kMoogCommand =
    "000000820000000000000000be428f5c00000000000000003d4ccccd00000000";
constexpr const char* kMoogReply =
    "0000000000000000000000130000000000000000be428f5c00000000000000003d23d70a00000000";

constexpr SetPoint kPoint{.order = PlatformOrder::kFollow,
                          .position_m = 0.05,
                          .velocity_m_s = -0.25,
                          .acceleration_m_s2 = 1.5};

TEST(PlainPlatformTest, AStateWithoutSenseIsRefusedAndAnAccelerationMayBeUnmeasured) {
  for (const char* const senseless : kPlainSenseless) {
    EXPECT_FALSE(plain::read_reply(bytes(senseless)).whole) << senseless;
  }
  const PlatformReply sut = plain::read_reply(bytes(kPlainUnmeasured));
  EXPECT_TRUE(sut.whole);
  EXPECT_EQ(sut.stage, PlatformStage::kFault);
  EXPECT_EQ(sut.fault, 5u);
}

TEST(PlainPlatformTest, ASetPointWithoutANumberAsksForNoMotion) {
  for (const double bad : {std::nan(""), HUGE_VAL}) {
    SetPoint point = kPoint;
    point.velocity_m_s = bad;
    EXPECT_EQ(hex(plain::command_packet(point, 7, kToken, 20).payload()),
              hex(plain::command_packet({}, 7, kToken, 20).payload()));
  }
}

TEST(PlainPlatformTest, TheEmulatorFollowsItsOwnerAlone) {
  emulators::PlatformEmulator emulator;
  SetPoint point = kPoint;
  const auto ask = [&](std::uint32_t sequence, std::uint32_t token, std::int64_t now_ns) {
    return plain::read_reply(
        emulator.take(plain::command_packet(point, sequence, token, 20).payload(), now_ns));
  };
  EXPECT_EQ(ask(1, kToken, 0).owner, kToken);
  point.position_m = -0.1;
  EXPECT_EQ(ask(1, kToken + 1, 1'000'000).owner, kToken);
  EXPECT_EQ(emulator.wish(1'000'000)->position_m, 0.05);
  // Nobody's any more: its owner was silent for longer than its set-point is valid.
  EXPECT_EQ(ask(2, kToken + 1, 30'000'000).owner, kToken + 1);
  point.order = PlatformOrder::kHold;
  EXPECT_EQ(ask(3, kToken + 1, 31'000'000).owner, 0u);
}

TEST(PlainPlatformTest, TheCommandIsTheOneOfTheTable) {
  EXPECT_EQ(hex(plain::command_packet(kPoint, 7, kToken, 20).payload()), kPlainCommand);
}

TEST(PlainPlatformTest, TheStateIsRead) {
  const PlatformReply sut = plain::read_reply(bytes(kPlainState));
  EXPECT_TRUE(sut.whole);
  EXPECT_EQ(sut.stage, PlatformStage::kFollowing);
  EXPECT_EQ(sut.sequence, 9u);
  EXPECT_EQ(sut.answers, 7u);
  EXPECT_EQ(sut.owner, kToken);
  EXPECT_EQ(sut.position_m, 0.04);
  EXPECT_EQ(sut.velocity_m_s, -0.2);
  EXPECT_EQ(sut.acceleration_m_s2, 1.25);
}

TEST(PlainPlatformTest, EveryByteChangedOrMissingIsRefused) {
  const auto good = bytes(kPlainState);
  for (std::size_t at = 0; at < good.size(); ++at) {
    auto damaged = good;
    damaged[at] ^= 0x10u;
    EXPECT_FALSE(plain::read_reply(damaged).whole) << at;
    EXPECT_FALSE(plain::read_reply(std::span(good).first(at)).whole) << at;
  }
}

TEST(PlainPlatformTest, TheEmulatorUnderstandsTheCommandAndIsUnderstood) {
  emulators::PlatformEmulator emulator;
  emulator.stand({.position_m = 0.01, .velocity_m_s = 0.2, .acceleration_m_s2 = -3.0});
  const auto reply =
      plain::read_reply(emulator.take(plain::command_packet(kPoint, 1, kToken, 20).payload(), 0));
  EXPECT_TRUE(reply.whole);
  EXPECT_EQ(reply.stage, PlatformStage::kFollowing);
  EXPECT_EQ(reply.acceleration_m_s2, -3.0);
  ASSERT_TRUE(emulator.wish(20'000'000));
  EXPECT_EQ(emulator.wish(20'000'000)->position_m, 0.05);
  EXPECT_FALSE(emulator.wish(20'000'001));
}

TEST(MoogPlatformTest, AnEngagedMachineGetsANewPosition) {
  const SetPoint point{.order = PlatformOrder::kFollow, .position_m = 0.05};
  EXPECT_EQ(hex(moog::command_packet(point, 3, -0.19).payload()), kMoogCommand);
}

TEST(MoogPlatformTest, TheReplyIsRead) {
  std::uint32_t state = 0;
  const PlatformReply sut = moog::read_reply(bytes(kMoogReply), state);
  EXPECT_TRUE(sut.whole);
  EXPECT_EQ(state, 3u);
  EXPECT_EQ(sut.stage, PlatformStage::kFollowing);
  EXPECT_NEAR(sut.position_m, 0.04, 1e-8);  // a float of 0.04 has an error below 2^-29
}

// The low nibble is the machine's state; 8 and above, and any fault bit, are a fault.
TEST(MoogPlatformTest, EveryStateOfTheMachineIsAStage) {
  auto reply = bytes(kMoogReply);
  std::uint32_t state = 0;
  for (std::uint8_t machine = 0; machine < 16; ++machine) {
    reply[11] = 0x30 | machine;
    const PlatformStage expected = machine == 2   ? PlatformStage::kHolding
                                   : machine == 3 ? PlatformStage::kFollowing
                                   : machine < 8  ? PlatformStage::kOff
                                                  : PlatformStage::kFault;
    EXPECT_EQ(moog::read_reply(reply, state).stage, expected) << int{machine};
    EXPECT_EQ(state, machine);
  }
  reply[11] = 3;
  reply[3] = 1;
  EXPECT_EQ(moog::read_reply(reply, state).stage, PlatformStage::kFault);
  EXPECT_EQ(moog::read_reply(reply, state).fault, 1u);
}

TEST(MoogPlatformTest, APositionWithoutANumberIsRefused) {
  auto reply = bytes(kMoogReply);
  reply[32] = 0x7f;  // 7fc00000: NaN
  reply[33] = 0xc0;
  std::uint32_t state = 0;
  EXPECT_FALSE(moog::read_reply(reply, state).whole);
  EXPECT_EQ(state, 0u);
}

TEST(MoogPlatformTest, EngagesWhenAskedParksWhenNotAndNeverResetsAFault) {
  const SetPoint follow{.order = PlatformOrder::kFollow};
  const auto word = [](const SetPoint& point, std::uint32_t state) {
    return std::stoul(hex(moog::command_packet(point, state, 0.0).payload()).substr(0, 8), nullptr,
                      16);
  };
  EXPECT_EQ(word(follow, 1), moog::kEngage);
  EXPECT_EQ(word(follow, 2), moog::kEngage);
  EXPECT_EQ(word({}, 1), moog::kPark);
  EXPECT_EQ(word({}, 3), moog::kPark);
  EXPECT_EQ(word({.order = PlatformOrder::kHold}, 3), moog::kNewPosition);
  EXPECT_EQ(word({.order = PlatformOrder::kHold}, 2), moog::kPark);
  for (const std::uint32_t busy : {0, 4, 5, 6, 7}) EXPECT_EQ(word(follow, busy), moog::kPark);
  for (std::uint32_t fault = 8; fault < 16; ++fault) EXPECT_EQ(word(follow, fault), moog::kDisable);
}

}  // namespace stillhand::device_rig::platform_protocol_test
