// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace stillhand::deploy {

/// How the participants of a lab find each other.
enum class Discovery : std::uint8_t {
  kPeers,     ///< each announces itself to the addresses of the inventory; no multicast
  kServer,    ///< through a discovery server on the first host; no multicast
  kMulticast  ///< multicast on the hosts' own network
};

/// "peers", "server", "multicast".
std::string_view name_of(Discovery discovery);

struct Rig {
  std::string name;      ///< for people and for names of files
  std::uint32_t number;  ///< key on the bus
  bool devices = false;  ///< `made_of: devices`: stillhand-device_rig in the place of stillhand-rig
};

/// One process that a host runs.
struct Placement {
  std::string service;  ///< of topics::kServices; "experiment" is `stillhand lab` itself
  std::uint32_t rig;    ///< number of one of Inventory::rigs
};

struct Host {
  std::string name;     ///< letters, digits and '-'
  std::string address;  ///< IPv4, dotted
  std::vector<std::string>
      start;  ///< words before a command that is to run there; empty: this machine
  std::filesystem::path prefix;  ///< absolute; where stillhand is installed on the host
  std::vector<Placement> services;
  std::string place = {};  ///< "file:line:column" of the host in the inventory
};

/// A lab of one or several machines, as in its inventory file (README, "The inventory").
/// read_inventory() guarantees that names, addresses and rig numbers are unique, and that every
/// service runs on exactly one host for each rig.
struct Inventory {
  std::filesystem::path file;
  std::string lab;           ///< letters, digits and '-'
  std::uint32_t domain = 0;  ///< DDS domain, 0 to 232
  Discovery discovery = Discovery::kPeers;
  std::filesystem::path security;  ///< folder of keys and permissions; empty: `security: none`
  std::vector<Host> hosts;         ///< at least one
  std::vector<Rig> rigs;           ///< at least one

  /// Several machines without keys: every program on their network can take part.
  [[nodiscard]] bool open_to_all() const { return hosts.size() > 1 && security.empty(); }
  /// The host of that name, or nullptr.
  [[nodiscard]] const Host* find_host(std::string_view name) const;
  /// The host that runs a service of a rig.  @param rig  number of one of `rigs`
  [[nodiscard]] const Host& host_of(std::string_view service, std::uint32_t rig) const;
  /// The rig of that number.
  [[nodiscard]] const Rig& rig(std::uint32_t number) const;
};

/// @throws ConfigError "file:line:column: key: got ..., want ..." for the first error
Inventory read_inventory(const std::filesystem::path& file);
/// The same from text.  @param file  name of the text in messages, and Inventory::file
Inventory parse_inventory(const std::string& yaml, const std::filesystem::path& file);

}  // namespace stillhand::deploy
