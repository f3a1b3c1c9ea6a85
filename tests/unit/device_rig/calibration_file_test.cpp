// SPDX-License-Identifier: Apache-2.0
// Eq. DR-16: whose calibration a session accepts.
#include "services/files/device_rig/calibration_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/core/contract/config_error.hpp"
#include "services/files/settings/load.hpp"
#include "services/files/settings/yaml_text.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::device_rig::calibration_file_test {

using testing::HasSubstr;

const std::string kDrive = "drive, serial 00003230-00005030-001d003a, AUX1";

class CalibrationFileTest : public testing::Test {
 protected:
  CalibrationFileTest() {
    record_.date = "2026-11-25";
    record_.device = kDrive;
    record_.fit.sensitivity = sensing_.load_cell_sensitivity_v_n;
    record_.fit.zero = sensing_.load_cell_offset_v;
  }
  std::string refusal(const std::string& today = "2026-11-30", std::int64_t max_age_days = 90) {
    return support::refusal([&] {
      check_calibration(CalibratedSignal::kForce, record_, device_, sensing_, max_age_days, today);
    });
  }

  sensing::Config sensing_;
  CalibrationRecord record_;
  std::string device_ = kDrive;
};

TEST_F(CalibrationFileTest, ThatOfThisDeviceAndTheseSettingsIsAccepted) {
  EXPECT_EQ(refusal(), "accepted");
  EXPECT_EQ(refusal("2027-02-23"), "accepted");  // 90 days
}

TEST_F(CalibrationFileTest, AnOldOneIsRefused) {
  EXPECT_THAT(refusal("2027-02-24"), HasSubstr("91 days ago"));
  EXPECT_THAT(refusal("2026-11-24"), HasSubstr("-1 days ago"));
}

TEST_F(CalibrationFileTest, NoneAndADateThatIsNoneAreRefused) {
  record_.date = "";
  EXPECT_THAT(refusal(), HasSubstr("no calibration of " + kDrive));
  record_.date = "2026-13-01";
  EXPECT_THAT(refusal(), HasSubstr("no calibration"));
}

TEST_F(CalibrationFileTest, ThatOfAnotherDeviceIsRefusedWithBothNames) {
  device_ = "drive, serial 1, AUX1";
  EXPECT_THAT(refusal(), HasSubstr(kDrive));
  EXPECT_THAT(refusal(), HasSubstr(device_));
}

TEST_F(CalibrationFileTest, ANumberThatSomebodyTypedOverIsNamed) {
  sensing_.load_cell_offset_v += 0.001;
  EXPECT_THAT(refusal(), HasSubstr("sensing.yaml: load_cell_offset_v: got 0.006, want 0.005"));
}

TEST_F(CalibrationFileTest, ASimulatedSignalAndAnAgeOfZeroAskForNone) {
  record_.date = "";
  EXPECT_EQ(refusal("2026-11-30", 0), "accepted");
  device_ = "";
  EXPECT_EQ(refusal(), "accepted");
}

TEST_F(CalibrationFileTest, TheAngleKeepsItsCountsOnTheWayToSensing) {
  DevicesConfig devices;
  devices.drive.counts_per_rev = 16'384;
  EXPECT_NO_THROW(check_counts(devices, sensing_)) << "the angle is simulated";
  devices.signals.angle = "drive";
  EXPECT_EQ(support::refusal([&] { check_counts(devices, sensing_); }),
            "devices.drive.counts_per_rev: got 16384, want 4096, encoder_counts_per_rev of "
            "sensing.yaml");
  devices.drive.counts_per_rev = 4096;
  EXPECT_NO_THROW(check_counts(devices, sensing_));
}

TEST_F(CalibrationFileTest, APlatformNeedsItsIdentificationAndAPushItsCheck) {
  const auto platform = [](const PlatformRecord& record, const char* device,
                           std::int64_t days = 90) {
    return support::refusal([&] { check_platform(record, device, days, "2026-11-30"); });
  };
  const PlatformRecord made{
      .date = "2026-11-25", .person = "kl", .device = "plain_udp at 10.0.0.2, port 16991"};
  EXPECT_EQ(platform(made, "plain_udp at 10.0.0.2, port 16991"), "accepted");
  EXPECT_EQ(platform(made, ""), "accepted");
  EXPECT_EQ(platform({}, "plain_udp at 10.0.0.2, port 16991", 0), "accepted");
  EXPECT_THAT(
      platform({}, "plain_udp at 10.0.0.2, port 16991"),
      HasSubstr("calibration.yaml: platform: got no calibration of plain_udp at 10.0.0.2, port "
                "16991, want `stillhand calibrate platform`"));
  EXPECT_THAT(platform(made, "moog_udp at 10.0.0.2, port 16991"), HasSubstr("one of \"moog_udp"));
  EXPECT_THAT(platform(made, "plain_udp at 10.0.0.2, port 16991", 4), HasSubstr("5 days ago"));

  const HandOffRecord checked{.date = "2026-11-29", .person = "kl", .devices = kDrive};
  EXPECT_NO_THROW(check_hand_off(checked, kDrive, 1, "2026-11-30"));
  EXPECT_NO_THROW(check_hand_off({}, "", 1, "2026-11-30"));
  EXPECT_THROW(check_hand_off(checked, kDrive, 1, "2026-12-01"), ConfigError);
  EXPECT_THROW(check_hand_off(checked, "another drive", 1, "2026-11-30"), ConfigError);
  EXPECT_THROW(check_hand_off({}, kDrive, 1, "2026-11-30"), ConfigError);
}

TEST_F(CalibrationFileTest, TheFileKeepsEveryBit) {
  Calibrations all;
  record_.fit.sensitivity = 0.1 + 1e-17;
  record_.person = "k'l: #";
  all.angle = record_;
  const auto again = settings::load_text<Calibrations>(settings::yaml_text(all), "calibration");
  EXPECT_EQ(again.angle.fit.sensitivity, record_.fit.sensitivity);
  EXPECT_EQ(again.angle.person, record_.person);
  EXPECT_EQ(again.force.date, "");
}

}  // namespace stillhand::device_rig::calibration_file_test
