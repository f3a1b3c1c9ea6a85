// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/hosts.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>

#include "apps/deploy/generated_file.hpp"
#include "apps/deploy/machine.hpp"
#include "apps/deploy/profiles.hpp"
#include "apps/lab/keys.hpp"
#include "apps/lab/lab_options.hpp"
#include "idl/topics.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/system/process/remark.hpp"

namespace stillhand::lab {
namespace {

// Folder of a host with the keys of its services, for its units and for a session.
std::filesystem::path installed_keys(const deploy::Inventory& inventory) {
  return std::filesystem::path(deploy::installed_folder(inventory)) / "security";
}

}  // namespace

Hosts::Hosts(const LabOptions& options)
    : domain_(options.domain),
      rig_(options.rig),
      local_{options.profiles, options.config, options.out, options.security},
      video_(options.video),
      attach_(options.attach) {
  if (!options.inventory.empty()) {
    inventory_ = deploy::read_inventory(options.inventory);
    domain_ = inventory_->domain;
    local_.security = inventory_->security;
    check(options);
    if (inventory_->open_to_all()) {
      runtime::remark(options.inventory.string() +
                      ": security: none: every program on the network of these machines can read, "
                      "disturb or imitate this session");
    }
  }
  // A service that runs already has checked its own keys.
  check_keys(local_.security, domain_,
             attach_ ? std::vector<std::string>{"experiment"} : services_on(host_of("experiment")));
}

// Refuses what an inventory allows but a session over it cannot do.
void Hosts::check(const LabOptions& options) const {
  const std::string file = options.inventory.string();
  if (std::ranges::find(inventory_->rigs, rig_, &deploy::Rig::number) == inventory_->rigs.end()) {
    throw ConfigError("--rig", fmt::to_string(rig_), "the number of a rig of " + file);
  }
  const deploy::Host* here = host_of("experiment");
  if (!here->start.empty()) {
    throw ConfigError(
        here->place + ": host " + here->name, "experiment on a host with \"start\"",
        "experiment on the host where `stillhand lab` runs, the one without \"start\"");
  }
  const auto own = deploy::own_addresses();
  if (std::ranges::find(own, here->address) == own.end()) {
    throw ConfigError(here->place + ": host " + here->name,
                      here->address + ", which no interface of this machine has",
                      "the address of the machine where `stillhand lab` runs");
  }
  const auto want_here = [&](std::string_view service, const std::string& option,
                             const std::string& why) {
    const deploy::Host* host = host_of(service);
    if (host == here) return;
    throw ConfigError(option, std::string(service) + " on the host " + host->name,
                      std::string(service) + " on this machine: " + why);
  };
  if (options.undeclared_effect != 0) {
    want_here("rig", "--undeclared-effect", "the sealed effect must not travel over a network");
  }
  if (!options.ride.empty()) want_here("motion", "--ride", "the ride is a file of this machine");
  if (options.who == Operator::kMouse && host_of("display") != host_of("human_operator")) {
    throw ConfigError("--operator", "mouse with display and human_operator on two hosts",
                      "both on the host with the mouse");
  }
}

const deploy::Host* Hosts::host_of(std::string_view service) const {
  return inventory_ ? &inventory_->host_of(service, rig_) : nullptr;
}

std::vector<std::string> Hosts::services_on(const deploy::Host* host) const {
  std::vector<std::string> services;
  for (const std::string_view service : topics::kServices) {
    if (host_of(service) == host) services.emplace_back(service);
  }
  return services;
}

RemoteHost* Hosts::remote_of(std::string_view service) const {
  const auto remote = remotes_.find(host_of(service));
  return remote == remotes_.end() ? nullptr : remote->second.get();
}

void Hosts::open(const runtime::Stop& stop) {
  if (!inventory_) return;
  const deploy::LabProfiles profiles(local_.profiles);
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(local_.config)) {
    if (entry.path().extension() != ".yaml") continue;
    files["config/" + entry.path().filename().string()] =
        recording::read_file(entry.path().string());
  }
  for (const deploy::Host& host : inventory_->hosts) {
    const std::string own = profiles.of(*inventory_, host);
    if (host.start.empty()) {
      local_.profiles = local_.out / "logs" / "profiles.xml";
      recording::write_file(local_.profiles, own);
      continue;
    }
    if (attach_) continue;  // its services have theirs
    auto remote =
        std::make_unique<RemoteHost>(host, local_.out / "logs" / ("host_" + host.name + ".log"));
    remote->open(stop);
    files["profiles.xml"] = own;
    remote->put(files);
    if (!local_.security.empty()) {
      const std::string authority =
          recording::read_file((local_.security / "authority.pem").string());
      const std::filesystem::path keys = installed_keys(*inventory_);
      remote->check(keys_script(keys, authority, services_on(&host)),
                    "the keys of its services in " + keys.string() + ", of this lab's authority");
    }
    remotes_[&host] = std::move(remote);
  }
}

Place Hosts::of(std::string_view service) const {
  const RemoteHost* remote = remote_of(service);
  if (remote == nullptr) return local_;
  const std::filesystem::path folder = remote->folder();
  return {folder / "profiles.xml", folder / "config", folder,
          local_.security.empty() ? "" : installed_keys(*inventory_)};
}

Launch Hosts::placed(const Launch& local) const {
  const RemoteHost* remote = remote_of(local.name);
  if (remote != nullptr) return remote->on_it(local);
  Launch launch = local;
  launch.arguments.insert(launch.arguments.end(), {"--end-with-parent", std::to_string(getpid())});
  return launch;
}

void Hosts::clear() noexcept {
  for (const auto& [host, remote] : remotes_) {
    try {
      remote->close();
    } catch (const std::exception&) {  // a folder in /tmp: the host itself clears it one day
    }
  }
  remotes_.clear();
}

void Hosts::bring_back() noexcept {
  const auto fetch = [&](std::string_view service, const std::string& file) {
    if (RemoteHost* remote = remote_of(service)) remote->fetch(file, local_.out / file);
  };
  for (const auto& [host, remote] : remotes_) {
    try {
      if (host == host_of("recorder")) fetch("recorder", "session.mcap");
      if (video_ && host == host_of("display")) fetch("display", "screen.avi");
      remote->close();
    } catch (const std::exception& error) {
      runtime::remark(fmt::format("host {}: the files in {} could not be brought here: {}",
                                  host->name, remote->folder(), error.what()));
    }
  }
  remotes_.clear();
}

void Hosts::bring_recording(const std::filesystem::path& file) noexcept {
  const std::filesystem::path to = local_.out / "session.mcap";
  const deploy::Host* host = host_of("recorder");
  try {
    if (file.empty()) throw std::runtime_error("the recorder did not report its file");
    if (host == nullptr || host->start.empty()) {
      std::filesystem::copy_file(file, to);
    } else {
      RemoteHost(*host, local_.out / "logs" / ("host_" + host->name + ".log")).fetch(file, to);
    }
  } catch (const std::exception& error) {
    runtime::remark(fmt::format("the recording stays {}, \"{}\": {}",
                                host == nullptr ? "where it is" : "on host " + host->name,
                                file.string(), error.what()));
  }
}

}  // namespace stillhand::lab
