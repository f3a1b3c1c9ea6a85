// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/odrive_settings.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>

namespace stillhand::device_rig::odrive {
namespace {

DriveConfig config() {
  DriveConfig config;
  config.watchdog_s = 0.05;
  config.ratio = 2.0;
  return config;
}

/// Good values of all settings.
std::map<std::string, std::string> good() {
  return {{"fw_version_minor", "5"},
          {"fw_version_revision", "6"},
          {"axis0.motor.is_calibrated", "1"},
          {"axis0.encoder.is_ready", "1"},
          {"axis0.config.enable_watchdog", "1"},
          {"axis0.config.watchdog_timeout", "0.050000"},
          {"axis0.motor.config.current_lim", "10.000000"},
          {"axis0.motor.config.torque_lim", "1.250000"},
          {"axis0.motor.config.torque_constant", "0.030630"},
          {"axis0.controller.config.input_mode", "1"}};
}

TEST(JudgeOdriveTest, EveryGoodSettingPassesAndNoAnswerPassesNone) {
  const auto values = good();
  for (const std::string_view name : settings_of(0)) {
    const auto value = values.find(std::string(name));
    EXPECT_FALSE(judge_setting(name, value == values.end() ? "0" : value->second, config()))
        << name;
    for (const char* none : {"no answer", "", "invalid property", "nan"}) {
      EXPECT_TRUE(judge_setting(name, none, config())) << name << ' ' << none;
    }
  }
}

TEST(JudgeOdriveTest, ASwitchIsTheOneOrTheOther) {
  for (const char* name :
       {"axis0.config.enable_watchdog", "axis0.controller.config.input_mode",
        "axis0.controller.config.enable_torque_mode_vel_limit", "axis0.config.startup_homing"}) {
    const bool on = !judge_setting(name, "1", config());
    EXPECT_NE(on, !judge_setting(name, "0", config())) << name;
    EXPECT_TRUE(judge_setting(name, "2", config())) << name;
  }
}

TEST(JudgeOdriveTest, ADriveWithoutItsWatchdogIsRefusedWithTheCommandThatMendsIt) {
  const auto sut = judge_setting("axis0.config.enable_watchdog", "0", config());
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->mend,
            "w axis0.config.enable_watchdog 1, then ss (saves, and starts the drive again)");
}

TEST(JudgeOdriveTest, WatchdogCurrentAndTorqueLieWithinTheSettings) {
  EXPECT_TRUE(judge_setting("axis0.config.watchdog_timeout", "0.060000", config()));
  EXPECT_TRUE(judge_setting("axis0.config.watchdog_timeout", "0.000000", config()));
  EXPECT_TRUE(judge_setting("axis0.motor.config.current_lim", "60.000000", config()));
  // As shipped: no limit.
  const auto sut = judge_setting("axis0.motor.config.torque_lim", "inf", config());
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->want, "more than 0 and at most 1.25 N m (drive.max_torque_n_m over drive.ratio)");
}

TEST(JudgeOdriveTest, AnotherFirmwareIsRefused) {
  EXPECT_TRUE(judge_setting("fw_version_minor", "6", config()));
  EXPECT_TRUE(judge_setting("fw_version_revision", "2", config()));
  EXPECT_TRUE(judge_setting("fw_version_major", "1", config()));
}

TEST(JudgeOdriveTest, TheOtherAxisHasTheSameSettings) {
  ASSERT_EQ(settings_of(0).size(), settings_of(1).size());
  for (std::size_t i = 0; i < settings_of(0).size(); ++i) {
    std::string name(settings_of(0)[i]);
    if (name.starts_with("axis0")) name.replace(0, 5, "axis1");
    EXPECT_EQ(settings_of(1)[i], name);
  }
}

}  // namespace
}  // namespace stillhand::device_rig::odrive
