// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <string_view>

#include "services/core/contract/config_error.hpp"
#include "services/files/rig/sealed_file.hpp"
#include "services/files/settings/load.hpp"
#include "services/processes/rig/shell.hpp"
#include "services/system/command_line/command_line.hpp"

namespace {

using namespace stillhand;

std::string text_for(const rig::SealedSeed& sealed, const rig::RigConfig& config) {
  return rig::sealed_text(rig::SealedEffect(sealed.seed, config).open(), sealed.nonce);
}

/// Draws the effect of a finished session again and writes it; uses no bus and no session.
int open_effect(int argc, char** argv) {
  try {
    command_line::Program cli("stillhand-rig: write the undeclared effect of a finished session");
    bool open = false;
    std::filesystem::path config;
    std::filesystem::path out;
    std::string verdict;
    cli.add_flag("--open-undeclared-effect", open, "read the seed from standard input").required();
    cli.add_option("--config", config, "folder with the settings of each service").required();
    cli.add_option("--out", out, "folder of the session").required();
    cli.add_option("--verdict", verdict,
                   "file in that folder with the verdict; its digest is added to the commitment");
    if (const auto status = cli.parse(argc, argv)) return *status;
    const auto sealed = rig::read_sealed_seed(std::cin);
    const auto settings = settings::load<rig::RigConfig>(config / "rig.yaml", "rig");
    rig::open_effect(out, text_for(sealed, settings), verdict);
    return 0;
  } catch (const ConfigError& error) {
    std::cerr << "stillhand-rig: " << error.what() << '\n';
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "stillhand-rig: " << error.what() << '\n';
    return 1;
  }
}

/// Reads the seed and writes the commitment; the effect stays inside this process.
rig::SealedEffect sealed_effect(const runtime::Service& service) {
  const auto sealed = rig::read_sealed_seed(std::cin);
  const auto config = service.config<rig::RigConfig>();
  rig::commit_effect(service.options().out, text_for(sealed, config));
  return {sealed.seed, config};
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--open-undeclared-effect") return open_effect(argc, argv);
  }
  bool holds_effect = false;
  return runtime::run_service(
      "rig", argc, argv,
      [&](runtime::Service& service) {
        const auto config = rig::seeded(service.config<rig::RigConfig>(), service.options().seed);
        rig::SimulatedPlant plant(config,
                                  holds_effect ? sealed_effect(service) : rig::SealedEffect());
        rig::Shell(service, plant, config.motor).run();
      },
      [&](command_line::Command& cli, runtime::ServiceOptions&) {
        cli.add_flag("--undeclared-effect", holds_effect,
                     "apply an undeclared effect: read its seed from standard input, write its "
                     "digest to --out");
      });
}
