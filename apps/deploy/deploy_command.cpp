// SPDX-License-Identifier: Apache-2.0
#include "apps/deploy/deploy_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/deploy/generate.hpp"
#include "apps/deploy/machine.hpp"
#include "apps/deploy/real_time_checks.hpp"
#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/report/result_files.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/system/command_line/command_line.hpp"
#include "services/system/process/shipped.hpp"

namespace stillhand::deploy {
namespace {

struct Arguments {
  std::filesystem::path inventory;
  std::filesystem::path profiles;  ///< qos/profiles.xml
  std::filesystem::path devices;   ///< devices.yaml; empty: no rig of devices
  std::string out;
  std::string host;
  std::string json;
};

int run_generate(const Arguments& arguments) {
  const Inventory inventory = read_inventory(arguments.inventory);
  const LabProfiles profiles(arguments.profiles);
  const auto left_over = generate(inventory, profiles, arguments.out);
  for (const Host& host : inventory.hosts) {
    fmt::print("{}: {}\n", (std::filesystem::path(arguments.out) / host.name).string(),
               host.address);
  }
  for (const auto& folder : left_over) {
    fmt::print("{}: from an earlier run; lab {} has no such host now\n", folder.string(),
               inventory.lab);
  }
  report::say_next("on each machine: stillhand deploy check " +
                   report::quoted_for_shell(arguments.inventory));
  return 0;
}

// Without a name, the host whose address this machine has.
const Host& this_host(const Inventory& inventory, const std::string& name) {
  std::vector<std::string> names;
  for (const Host& host : inventory.hosts) names.push_back(host.name);
  if (!name.empty()) {
    if (const Host* host = inventory.find_host(name)) return *host;
    throw ConfigError("--host", name, fmt::format("one of {}", fmt::join(names, ", ")));
  }
  const std::vector<std::string> own = own_addresses();
  for (const Host& host : inventory.hosts) {
    if (std::ranges::find(own, host.address) != own.end()) return host;
  }
  throw ConfigError("--host",
                    fmt::format("none, and no address of this machine ({}) is in the "
                                "inventory",
                                fmt::join(own, ", ")),
                    fmt::format("the name of this machine: {}", fmt::join(names, ", ")));
}

const char* word_of(State state) {
  constexpr std::array kWords{"good", "wrong", "not checked"};
  return kWords.at(static_cast<std::size_t>(state));
}

std::string json_of(const Inventory& inventory, const Host& host,
                    const std::vector<Finding>& findings, bool good) {
  nlohmann::ordered_json json{{"lab", inventory.lab}, {"host", host.name}, {"good", good}};
  json["checks"] = nlohmann::ordered_json::array();
  for (const Finding& each : findings) {
    json["checks"].push_back({{"check", each.check},
                              {"state", word_of(each.state)},
                              {"what", each.what},
                              {"mend", each.mend}});
  }
  return json.dump(2) + "\n";
}

int run_check(const Arguments& arguments) {
  report::ResultFiles files({{"--json", arguments.json}},
                            {arguments.inventory, arguments.profiles});
  const Inventory inventory = read_inventory(arguments.inventory);
  const Host& host = this_host(inventory, arguments.host);
  const LabProfiles profiles(arguments.profiles);
  std::vector<Finding> findings = check_machine(inventory, host, profiles.buffers());
  std::ranges::move(check_real_time_kernel(), std::back_inserter(findings));
  if (!arguments.devices.empty()) {
    std::ranges::move(check_devices(arguments.devices), std::back_inserter(findings));
  }
  const bool all_good = std::ranges::none_of(
      findings, [](const Finding& each) { return each.state == State::kWrong; });
  for (const Finding& each : findings) {
    fmt::print("{:<12} {:<12} {}{}{}\n", word_of(each.state), each.check, each.what,
               each.mend.empty() ? "" : ": ", each.mend);
  }
  if (files.wants("--json")) {
    files.set_json("--json", json_of(inventory, host, findings, all_good));
    files.publish();
  }
  if (all_good) {
    report::say_next("stillhand lab --inventory " + report::quoted_for_shell(arguments.inventory));
  }
  return all_good ? 0 : 1;
}

}  // namespace

void add_deploy_command(command_line::Command& cli, int& status) {
  auto arguments = std::make_shared<Arguments>();
  arguments->profiles = runtime::shipped("qos/profiles.xml");
  command_line::Command verb = cli.add_subcommand(
      "deploy",
      "Sets up a lab of several machines from one inventory (deploy/inventory.example.yaml).\n"
      "Example: stillhand deploy generate lab.yaml --out generated\n"
      "         stillhand deploy check lab.yaml          (on each machine)");
  verb.require_subcommand();
  const auto common = [&](command_line::Command& sub) {
    sub.add_option("inventory", arguments->inventory, "YAML file with the services of each machine")
        .required();
    sub.add_option("--profiles", arguments->profiles,
                   "QoS profiles from which the lab's profiles are made");
  };
  command_line::Command make = verb.add_subcommand(
      "generate",
      "Writes DIR/HOST for every machine: profiles.xml (its transport and discovery), systemd\n"
      "units, stillhand.target, firewall.nft, sysctl.conf. It writes all files or none, and the\n"
      "same inventory gives the same files. deploy/README.md says where each file belongs.");
  common(make);
  make.add_option("--out", arguments->out, "folder for the machines' folders")
      .required()
      .check(settings::check_name);
  make.callback([arguments, &status] { status = run_generate(*arguments); });
  command_line::Command check =
      verb.add_subcommand("check",
                          "Checks this machine as a host of the lab: address, clock, rights, "
                          "buffers, ports,\nprocessors, certificates and keys. Each check prints "
                          "one line, with the remedy if something\nis wrong. Exit status: 0 "
                          "nothing is wrong, 1 something is wrong, 2 the inventory is refused.");
  common(check);
  check.add_option("--host", arguments->host,
                   "this machine's host; by default the one whose address it has");
  check
      .add_option("--devices", arguments->devices,
                  "devices.yaml of a rig of devices: also check the ports and interfaces it names")
      .check(settings::check_name);
  check.add_option("--json", arguments->json, "also write the results to this file")
      .check(settings::check_name);
  check.callback([arguments, &status] { status = run_check(*arguments); });
}

}  // namespace stillhand::deploy
