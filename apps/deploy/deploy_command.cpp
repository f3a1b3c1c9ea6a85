// SPDX-License-Identifier: Apache-2.0
#include "apps/deploy/deploy_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/deploy/generate.hpp"
#include "apps/deploy/machine.hpp"
#include "apps/report/result_files.hpp"
#include "services/contract/config_error.hpp"
#include "services/runtime/process/shipped.hpp"
#include "services/settings/check_name.hpp"

namespace stillhand::deploy {
namespace {

struct Words {
  std::filesystem::path inventory;
  std::filesystem::path profiles;  ///< qos/profiles.xml
  std::string out;
  std::string host;
  std::string json;
};

int run_generate(const Words& words) {
  const Inventory inventory = read_inventory(words.inventory);
  const LabProfiles profiles(words.profiles);
  const auto left_over = generate(inventory, profiles, words.out);
  for (const Host& host : inventory.hosts) {
    fmt::print("{}: {}\n", (std::filesystem::path(words.out) / host.name).string(), host.address);
  }
  for (const auto& folder : left_over) {
    fmt::print("{}: of an earlier run, no host of lab {} any more\n", folder.string(),
               inventory.lab);
  }
  return 0;
}

// Without a name: the host whose address this machine has.
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
                    fmt::format("none, and this machine ({}) has no address of the "
                                "inventory",
                                fmt::join(own, ", ")),
                    fmt::format("the name of this machine: {}", fmt::join(names, ", ")));
}

const char* word_of(State state) {
  switch (state) {
    case State::kGood:
      return "good";
    case State::kWrong:
      return "wrong";
    case State::kNotChecked:
      return "not checked";
  }
  return "";
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

int run_check(const Words& words) {
  report::ResultFiles files({{"--json", words.json}}, {words.inventory, words.profiles});
  const Inventory inventory = read_inventory(words.inventory);
  const Host& host = this_host(inventory, words.host);
  const LabProfiles profiles(words.profiles);
  const std::vector<Finding> findings = check_machine(inventory, host, profiles.buffers());
  const bool all_good = std::ranges::none_of(
      findings, [](const Finding& each) { return each.state == State::kWrong; });
  for (const Finding& each : findings) {
    fmt::print("{:<12} {:<12} {}{}{}\n", word_of(each.state), each.check, each.what,
               each.mend.empty() ? "" : ": ", each.mend);
  }
  if (files.wants("--json")) {
    files.set("--json", json_of(inventory, host, findings, all_good));
    files.publish();
  }
  return all_good ? 0 : 1;
}

}  // namespace

void add_deploy_command(CLI::App& cli, int& status) {
  auto words = std::make_shared<Words>();
  words->profiles = runtime::shipped("qos/profiles.xml");
  CLI::App* verb = cli.add_subcommand(
      "deploy",
      "A lab of several machines from one inventory (deploy/inventory.example.yaml).\n"
      "Example: stillhand deploy generate lab.yaml --out generated\n"
      "         stillhand deploy check lab.yaml          (on each machine)");
  verb->require_subcommand(1);
  const auto common = [&](CLI::App* sub) {
    sub->add_option("inventory", words->inventory, "YAML file that says which service runs where")
        ->required();
    sub->add_option("--profiles", words->profiles, "QoS profiles that the lab's are made from")
        ->capture_default_str();
  };
  CLI::App* make = verb->add_subcommand(
      "generate",
      "Writes DIR/HOST for every machine: profiles.xml (its transport and discovery), systemd\n"
      "units, stillhand.target, firewall.nft, sysctl.conf. All or nothing; the same inventory\n"
      "gives the same files. deploy/README.md tells where each belongs.");
  common(make);
  make->add_option("--out", words->out, "folder for the machines' folders")
      ->required()
      ->check(settings::check_name);
  make->callback([words, &status] { status = run_generate(*words); });
  CLI::App* check = verb->add_subcommand(
      "check",
      "What is wrong with this machine as a host of the lab, and how to mend it, a line each:\n"
      "address, clock, rights, buffers, ports, processors, certificates. Exit status 0 when\n"
      "nothing is, 1 when something is, 2 when the inventory is refused.");
  common(check);
  check->add_option("--host", words->host,
                    "which host this machine is; else the one whose address it has");
  check->add_option("--json", words->json, "write the findings to this file, too")
      ->check(settings::check_name);
  check->callback([words, &status] { status = run_check(*words); });
}

}  // namespace stillhand::deploy
