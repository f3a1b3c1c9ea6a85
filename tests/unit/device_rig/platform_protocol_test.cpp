// SPDX-License-Identifier: Apache-2.0
// The packets below were written out from the documents by a Python script of struct.pack() calls,
// not by this code.
#include "services/device_rig/core/platform_protocol.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/emulators/platform_emulator.hpp"
#include "tests/support/hex.hpp"

namespace stillhand::device_rig {
namespace {

constexpr const char* kPlainCommand =
    "534850430100010007000000140000009a9999999999a93f000000000000d0bf000000000000f83f1be0e0c7";
constexpr const char* kPlainState =
    "534850530100020009000000070000007b14ae47e17aa43f9a9999999999c9bf000000000000f43f00000000"
    "e98ff36f";
constexpr const char* kMoogCommand =
    "000000820000000000000000be428f5c00000000000000003d4ccccd00000000";
constexpr const char* kMoogReply =
    "0000000000000000000000130000000000000000be428f5c00000000000000003d23d70a00000000";

TEST(PlainPlatformTest, TheCommandIsTheOneOfTheTable) {
  const SetPoint point{
      .follow = true, .position_m = 0.05, .velocity_m_s = -0.25, .acceleration_m_s2 = 1.5};
  EXPECT_EQ(hex(plain::command_packet(point, 7, 20).payload()), kPlainCommand);
}

TEST(PlainPlatformTest, TheStateIsRead) {
  const PlatformReply sut = plain::read_reply(bytes(kPlainState));
  EXPECT_TRUE(sut.whole);
  EXPECT_EQ(sut.stage, PlatformStage::kFollowing);
  EXPECT_EQ(sut.sequence, 9u);
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
  const SetPoint point{
      .follow = true, .position_m = 0.05, .velocity_m_s = -0.25, .acceleration_m_s2 = 1.5};
  const auto reply =
      plain::read_reply(emulator.take(plain::command_packet(point, 1, 20).payload(), 0));
  EXPECT_TRUE(reply.whole);
  EXPECT_EQ(reply.stage, PlatformStage::kFollowing);
  EXPECT_EQ(reply.acceleration_m_s2, -3.0);
  ASSERT_TRUE(emulator.wish(20'000'000));
  EXPECT_EQ(emulator.wish(20'000'000)->position_m, 0.05);
  EXPECT_FALSE(emulator.wish(20'000'001));
}

TEST(MoogPlatformTest, AnEngagedMachineGetsANewPosition) {
  const SetPoint point{.follow = true, .position_m = 0.05};
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

TEST(MoogPlatformTest, EngagesWhenAskedParksWhenNotAndNeverResetsAFault) {
  const SetPoint follow{.follow = true};
  const auto word = [](const SetPoint& point, std::uint32_t state) {
    return std::stoul(hex(moog::command_packet(point, state, 0.0).payload()).substr(0, 8), nullptr,
                      16);
  };
  EXPECT_EQ(word(follow, 1), moog::kEngage);
  EXPECT_EQ(word(follow, 2), moog::kEngage);
  EXPECT_EQ(word({}, 1), moog::kPark);
  for (std::uint32_t fault = 8; fault < 16; ++fault) EXPECT_EQ(word(follow, fault), moog::kDisable);
}

}  // namespace
}  // namespace stillhand::device_rig
