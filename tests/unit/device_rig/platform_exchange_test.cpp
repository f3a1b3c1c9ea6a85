// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/platform_exchange.hpp"

#include <gtest/gtest.h>

#include "tests/emulators/platform_emulator.hpp"

namespace stillhand::device_rig::platform_exchange_test {

constexpr std::int64_t kMs = 1'000'000;

class PlatformExchangeTest : public testing::Test {
 protected:
  std::vector<std::uint8_t> ask(std::int64_t now_ns) {
    return platform_.take(sut_.command({.order = PlatformOrder::kHold}, now_ns).payload(), now_ns);
  }
  emulators::PlatformEmulator platform_;
  PlatformExchange sut_{Parts::Platform::kPlain, 7, 20, 0.0};
};

TEST_F(PlatformExchangeTest, AReplyIsAsOldAsTheCommandThatItAnswers) {
  const auto first = ask(1000 * kMs);
  const auto second = ask(1001 * kMs);
  EXPECT_TRUE(sut_.take(first, 1400 * kMs));
  EXPECT_EQ(sut_.sample().at_ns, 1000 * kMs);
  EXPECT_TRUE(sut_.take(second, 1401 * kMs));
  EXPECT_EQ(sut_.sample().at_ns, 1001 * kMs);
}

TEST_F(PlatformExchangeTest, AReplyThatComesAgainOrTooLateOrAnswersNothingIsNone) {
  const auto first = ask(1000 * kMs);
  const auto second = ask(1001 * kMs);
  EXPECT_TRUE(sut_.take(second, 1002 * kMs));
  EXPECT_FALSE(sut_.take(second, 1003 * kMs));
  EXPECT_FALSE(sut_.take(first, 1003 * kMs));
  EXPECT_EQ(sut_.sample().at_ns, 1001 * kMs);
  // A reply to another program's command.
  PlatformExchange other{Parts::Platform::kPlain, 8, 20, 0.0};
  EXPECT_FALSE(other.take(second, 1004 * kMs));
  EXPECT_EQ(other.sample().count, 0u);
  EXPECT_EQ(other.sample().damaged, 1u);
}

// 256 times are kept.  That of the 257th command lies in the place of the first one, and would make
// a reply to the first one look young.
TEST_F(PlatformExchangeTest, ACommandOfLongAgoIsForgotten) {
  const auto first = ask(1000 * kMs);
  const auto second = ask(1001 * kMs);
  for (int i = 2; i <= 256; ++i) ask((1000 + i) * kMs);
  EXPECT_FALSE(sut_.take(first, 1300 * kMs));
  EXPECT_TRUE(sut_.take(second, 1300 * kMs));
  EXPECT_EQ(sut_.sample().at_ns, 1001 * kMs);
}

}  // namespace stillhand::device_rig::platform_exchange_test
