// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/parts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "services/devices/device_rig/load_devices.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::device_rig::parts_test {

std::string refusal(const DevicesConfig& config) {
  return support::refusal([&] { parts_of(config); });
}

TEST(PartsTest, TheDefaultsNeedNoDevice) {
  const Parts sut = parts_of({});
  EXPECT_FALSE(sut.needs_drive());
  EXPECT_FALSE(sut.needs_platform());
  EXPECT_FALSE(sut.any_device());
  EXPECT_EQ(in_words({}), "everything simulated");
}

TEST(PartsTest, AMixtureIsNamed) {
  DevicesConfig config;
  config.signals.angle = config.signals.force = config.signals.motor = "drive";
  const Parts sut = parts_of(config);
  EXPECT_TRUE(sut.needs_drive());
  EXPECT_EQ(in_words(config.signals),
            "force drive, angle drive, motor drive; simulated: acceleration, platform");
}

TEST(PartsTest, AMotorThatIsOffStillNeedsTheDriveToSaySo) {
  DevicesConfig config;
  config.signals.motor = "off";
  EXPECT_TRUE(parts_of(config).needs_drive());
}

TEST(PartsTest, AnIioDeviceServesAccelerationOrForceWithoutADrive) {
  DevicesConfig config;
  config.signals.acceleration = config.signals.force = "iio";
  const Parts sut = parts_of(config);
  EXPECT_EQ(sut.acceleration, Parts::Source::kIio);
  EXPECT_EQ(sut.force, Parts::Source::kIio);
  EXPECT_FALSE(sut.needs_drive());
  EXPECT_TRUE(sut.any_device());
  config.signals.angle = "iio";
  EXPECT_THAT(refusal(config), testing::HasSubstr("devices.signals.angle: got iio, want one of"));
}

TEST(PartsTest, AMountIsARotationAndHasNoSign) {
  DevicesConfig config;
  config.signals.acceleration = "iio";
  config.accelerometer.mount = "0 1 0, -1 0 0, 0 0 1";
  EXPECT_EQ(refusal(config), "accepted");
  config.accelerometer.sign = -1;
  EXPECT_THAT(refusal(config),
              testing::HasSubstr("devices.accelerometer.sign: got -1 with a mount"));
  config.accelerometer.mount = "1 0 0";
  EXPECT_THAT(refusal(config), testing::HasSubstr("devices.accelerometer.mount: got 1 0 0, want"));
}

TEST(PartsTest, WordsAndPartsThatDoNotFitAreRefused) {
  DevicesConfig config;
  config.signals.force = "platform";
  EXPECT_THAT(refusal(config),
              testing::HasSubstr("devices.signals.force: got platform, want one of"));
  config = {};
  config.signals.motor = "drive";
  EXPECT_THAT(refusal(config), testing::HasSubstr("devices.signals.angle"));
  config = {};
  config.signals.acceleration = "platform";
  EXPECT_THAT(refusal(config), testing::HasSubstr("plain_udp"));
  config = {};
  config.drive.kind = "vesc";
  EXPECT_THAT(refusal(config),
              testing::HasSubstr("devices.drive.kind: got vesc, want one of moteus, moteus_can"));
  config = {};
  config.drive.torque_sign = 0;
  EXPECT_THAT(refusal(config), testing::HasSubstr("1 or -1"));
  config = {};
  config.signals.acceleration = config.signals.force = "drive";
  config.drive.acceleration_input = 1;
  EXPECT_THAT(refusal(config), testing::HasSubstr("the other connector"));
  config = {};
  config.drive.watchdog_s = 0.02;
  config.drive.period_ticks = 10;
  EXPECT_THAT(refusal(config), testing::HasSubstr("three times"));
  config.drive.watchdog_s = 0.03;
  EXPECT_EQ(refusal(config), "accepted");
}

TEST(LoadDevicesTest, AWordThatIsNoPartIsRefusedWithFileKeyAndTheWordsThatThereAre) {
  const support::Folder folder;
  const auto file = folder / "devices.yaml";
  const auto refused = [&](const std::string& text) {
    std::ofstream(file) << text;
    return support::refusal([&] { load_devices(file); });
  };
  EXPECT_EQ(
      refused("signals: {force: spring}\n"),
      file.string() + ": devices.signals.force: got spring, want one of simulated, drive, iio");
  EXPECT_EQ(refused("signals: {force: [iio, drive]}\n"),
            file.string() +
                ":1:18: devices.signals.force: got a list, want text of 1 to 20 characters: force "
                "of the hand on the stick: simulated, drive (an analogue input of it) or iio");
  EXPECT_EQ(refused("signals: {force: iio}\n"), "accepted");
}

}  // namespace stillhand::device_rig::parts_test
