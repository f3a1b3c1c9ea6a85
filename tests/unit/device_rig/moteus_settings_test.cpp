// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/moteus_settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/hex.hpp"

namespace stillhand::device_rig::moteus::moteus_settings_test {

constexpr SettingLimits kLimits{.max_current_a = 10.0, .travel_rev = 0.083};

TEST(JudgeSettingTest, TheDriverIsOffAfterATimeoutOrTheDriveIsRefused) {
  EXPECT_FALSE(judge_setting("servo.timeout_mode", "0", kLimits));
  for (const char* shipped : {"12", "10", "15", "nan", "", "no answer"}) {
    const auto sut = judge_setting("servo.timeout_mode", shipped, kLimits);
    ASSERT_TRUE(sut) << shipped;
    EXPECT_EQ(sut->mend, "conf set servo.timeout_mode 0, then conf write");
  }
}

// The watchdog ends a command within 100 ms, the current is at most that of the settings, a mode
// without limits is refused, and the limits of the position lie outside of the stop.
TEST(JudgeSettingTest, EverySettingHasItsLimits) {
  const struct {
    const char* name;
    std::vector<const char*> good, wrong;
  } cases[] = {{"servo.default_timeout_s", {"0.100000"}, {"nan", "0", "0.2", "-1", "inf"}},
               {"servo.max_current_A", {"10.000000"}, {"10.5", "nan"}},
               {"servo.fixed_voltage_mode", {"0"}, {"1"}},
               {"servopos.position_min", {"nan", "-0.1"}, {"-0.01"}},
               {"servopos.position_max", {"0.1"}, {"0.01", "ERR unknown"}}};
  for (const auto& [name, good, wrong] : cases) {
    for (const char* value : good) EXPECT_FALSE(judge_setting(name, value, kLimits)) << name;
    for (const char* value : wrong) EXPECT_TRUE(judge_setting(name, value, kLimits)) << value;
  }
}

TEST(AskSettingTest, TheLongestNameFitsAFrame) {
  for (const std::string_view name : kSettings) {
    const Frame frame = ask_setting(name);
    const std::string text(frame.bytes.begin(),
                           frame.bytes.begin() + static_cast<long>(frame.size));
    EXPECT_THAT(text, testing::HasSubstr("conf get " + std::string(name) + "\n"));
  }
  EXPECT_EQ(hex(poll_setting().payload()), "420130");  // can.md: 48 bytes of channel 1
}

TEST(ConsoleAnswerTest, IsALineFromPieces) {
  ConsoleAnswer sut;
  const auto take = [&](const std::string& text) {
    sut.take({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  };
  take("0.1");
  EXPECT_FALSE(sut.line());
  take("00\r\nmore");
  EXPECT_EQ(sut.line(), "0.100");
}

}  // namespace stillhand::device_rig::moteus::moteus_settings_test
