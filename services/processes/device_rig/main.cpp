// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>

#include "services/devices/device_rig/device_plant.hpp"
#include "services/devices/device_rig/load_devices.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/files/settings/load.hpp"
#include "services/files/settings/placed_error.hpp"
#include "services/processes/rig/shell.hpp"
#include "services/system/command_line/command_line.hpp"

namespace {

// METHOD Eq. DR-16: what sensing uses is what was calibrated on these devices, not long ago.
void refuse_uncalibrated(const stillhand::device_rig::DevicePlant& plant,
                         const stillhand::device_rig::DevicesConfig& devices,
                         const std::filesystem::path& folder) {
  using namespace stillhand;
  const auto sensing = settings::load<sensing::Config>(folder / "sensing.yaml", "sensing");
  device_rig::check_counts(devices, sensing);
  if (devices.calibration.max_age_days == 0) return;
  const auto calibrations = device_rig::load_calibrations(folder / "calibration.yaml");
  const std::int64_t days = devices.calibration.max_age_days;
  const std::string today = device_rig::today();
  for (const device_rig::CalibratedSignal signal : device_rig::kCalibratedSignals) {
    device_rig::check_calibration(signal, calibrations.of(signal), plant.device_of(signal), sensing,
                                  days, today);
  }
  device_rig::check_platform(calibrations.platform, plant.platform_device(), days, today);
  device_rig::check_hand_off(calibrations.check, plant.pushing_devices(),
                             devices.calibration.check_max_age_days, today);
}

// METHOD Eq. DR-17, DR-18: 0 where nobody identified this platform.
double platform_lag_s(const stillhand::device_rig::DevicesConfig& devices,
                      const std::filesystem::path& folder) {
  const auto all = stillhand::device_rig::load_calibrations(folder / "calibration.yaml");
  return all.platform.device == stillhand::device_rig::platform_device(devices) ? all.platform.lag_s
                                                                                : 0.0;
}

}  // namespace

// On the bus it is the session's rig.
int main(int argc, char** argv) {
  using namespace stillhand;
  std::filesystem::path file;
  return runtime::run_service(
      "rig", argc, argv,
      [&](runtime::Service& service) {
        const auto rig = rig::seeded(service.config<rig::RigConfig>(), service.options().seed);
        if (file.empty()) file = service.options().config / "devices.yaml";
        const auto devices = device_rig::load_devices(file);
        const auto& folder = service.options().config;
        auto plant = settings::placed(file.string(), [&] {
          return device_rig::DevicePlant(rig, devices, platform_lag_s(devices, folder));
        });
        refuse_uncalibrated(plant, devices, folder);
        rig::Shell(service, plant, rig.motor).run();
        for (const std::string& line : plant.counts()) {
          std::cerr << "stillhand-device_rig: " << line << '\n';
        }
      },
      [&](command_line::Command& cli, runtime::ServiceOptions&) {
        cli.description(
            "stillhand-device_rig: the rig of a session, made of devices and simulated parts; "
            "`stillhand lab --rig devices` starts it");
        cli.add_option("--devices", file,
                       "which device serves which signal [devices.yaml of --config]")
            .check(settings::check_name);
      });
}
