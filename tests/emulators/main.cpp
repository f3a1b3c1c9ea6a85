// SPDX-License-Identifier: Apache-2.0
// emulated_laboratory: a moteus drive behind a pseudo-terminal and a platform behind UDP, with the
// simulated rig's body, stick and platform between them.  README.md.
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <optional>

#include "services/core/contract/config_error.hpp"
#include "services/core/rig/plant.hpp"
#include "services/files/settings/load.hpp"
#include "services/system/command_line/command_line.hpp"
#include "services/system/process/real_time.hpp"
#include "tests/emulators/emulated_loop.hpp"

namespace {

int run(int argc, char** argv) {
  using namespace stillhand;
  emulators::LoopOptions options;
  std::filesystem::path config;
  std::filesystem::path profiles;
  std::uint64_t seed = 1;
  std::optional<std::uint32_t> domain;
  bool ordinary = false;
  command_line::Program cli("emulated_laboratory: a servo drive and a platform that are not there");
  cli.add_option("--drive-link", options.drive_link, "name of the drive's serial port").required();
  cli.add_option("--platform-port", options.platform_port, "UDP port of the platform").required();
  cli.add_option("--config", config, "folder with rig.yaml: body and stick").required();
  cli.add_option("--profiles", profiles, "QoS profiles");
  cli.add_option("--domain", domain, "DDS domain of the session whose person holds the stick");
  cli.add_option("--seed", seed, "of the sensors' noise");
  cli.add_flag("--uart", options.uart, "the drive's own UART: lines with checksums");
  cli.add_option("--set", options.settings, "NAME=VALUE of the drive's settings").repeatable();
  cli.add_option("--accelerometer", options.accelerometer,
                 "FIFO of an IIO accelerometer's samples");
  cli.add_option("--bridge", options.bridge, "FIFO of an IIO bridge converter's samples");
  cli.add_flag("--no-real-time", ordinary, "do not ask for real-time priority");
  if (const auto status = cli.parse(argc, argv)) return *status;
  runtime::end_with_parent(getppid());
  if (!ordinary) runtime::become_real_time();
  const auto rig = rig::seeded(settings::load<rig::RigConfig>(config / "rig.yaml", "rig"), seed);
  std::optional<emulators::Person> person;
  if (domain) person.emplace(*domain, profiles);
  emulators::EmulatedLoop loop(options, rig);
  loop.run(person ? &*person : nullptr);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "emulated_laboratory: %s\n", error.what());
    return 2;
  }
}
