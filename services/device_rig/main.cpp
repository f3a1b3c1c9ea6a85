// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <filesystem>

#include "services/device_rig/device_plant.hpp"
#include "services/rig/shell.hpp"
#include "services/settings/check_name.hpp"
#include "services/settings/load.hpp"

// On the bus it is the session's rig.
int main(int argc, char** argv) {
  using namespace stillhand;
  std::filesystem::path file;
  return runtime::run_service(
      "rig", argc, argv,
      [&](runtime::Service& service) {
        const auto rig = rig::seeded(service.config<rig::RigConfig>(), service.options().seed);
        if (file.empty()) file = service.options().config / "devices.yaml";
        const auto devices = settings::load<device_rig::DevicesConfig>(file, "devices");
        device_rig::DevicePlant plant(rig, devices);
        rig::Shell(service, plant, rig.motor).run();
      },
      [&](CLI::App& cli, runtime::ServiceOptions&) {
        cli.description(
            "stillhand-device_rig: the rig of a session, made of devices and simulated parts; "
            "`stillhand lab --rig devices` starts it");
        cli.add_option("--devices", file,
                       "which device serves which signal [devices.yaml of --config]")
            ->check(settings::check_name);
      });
}
