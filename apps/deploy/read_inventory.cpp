// SPDX-License-Identifier: Apache-2.0
// Reads the inventory: the values of each key, and the consistency of the whole.
#include <algorithm>
#include <cctype>
#include <limits>
#include <utility>

#include "apps/deploy/inventory.hpp"
#include "apps/deploy/inventory_values.hpp"
#include "apps/deploy/placements.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/settings/section.hpp"
#include "services/system/process/domain.hpp"
#include "services/system/process/shipped.hpp"

namespace stillhand::deploy {
namespace {

using settings::Entry;
using settings::SectionReader;

struct SeenHost {
  std::string path;
  const Entry& name;
  const Entry& address;
};

/// Reads one file; each member reads one kind of entry.
class Reader {
 public:
  Reader(Entry top, const std::filesystem::path& file) : top_(std::move(top)) {
    inventory_.file = file;
  }

  Inventory read() {
    SectionReader reader(top_, "inventory");
    allow_only(reader, {"lab", "domain", "discovery", "security", "rigs", "hosts"});
    inventory_.lab = name_in(required(reader, top_, "inventory", "lab", "lab: a name for the lab"),
                             "inventory.lab");
    std::int64_t domain = 0;
    reader("domain", domain, Range{0, runtime::kMaxDomain}, "DDS domain");
    inventory_.domain = static_cast<std::uint32_t>(domain);
    read_discovery(reader);
    read_security(reader);
    if (const Entry* rigs = reader.find("rigs")) {
      read_rigs(*rigs);
    } else {
      inventory_.rigs.push_back({"1", 1});
    }
    const Entry& hosts = required(reader, top_, "inventory", "hosts", "hosts: a list of machines");
    read_hosts(hosts);
    placements_.refuse_absent(hosts);
    if (reader.find("security") == nullptr && inventory_.hosts.size() > 1) {
      throw ConfigError(hosts.place + ": inventory", "several machines and no \"security\"",
                        "security: a folder that deploy/security/make.sh makes; or security: none, "
                        "with which every program on their network can take part");
    }
    return std::move(inventory_);
  }

 private:
  void read_discovery(SectionReader& reader) {
    const Entry* entry = reader.find("discovery");
    if (entry == nullptr) return;
    for (const auto each : {Discovery::kPeers, Discovery::kServer, Discovery::kMulticast}) {
      if (entry->text != name_of(each)) continue;
      inventory_.discovery = each;
      return;
    }
    refuse(*entry, "inventory.discovery", "peers, server or multicast");
  }

  void read_security(SectionReader& reader) {
    const Entry* entry = reader.find("security");
    if (entry == nullptr || entry->text == "none") return;
    const std::string want = "a folder with the lab's keys, relative to the inventory, or none";
    inventory_.security =
        inventory_.file.parent_path() / text_of(*entry, "inventory.security", want);
    std::error_code ignored;
    if (!std::filesystem::is_directory(inventory_.security, ignored)) {
      throw ConfigError(entry->place + ": inventory.security",
                        "no folder " + inventory_.security.string(), want);
    }
    // Measured: a stranger exchanged every sample with a secured service through a plain server.
    if (inventory_.discovery == Discovery::kServer) {
      throw ConfigError(entry->place + ": inventory.security",
                        "keys together with a discovery server, which admits strangers",
                        "discovery: peers");
    }
    // Measured: half of the starts of ten secured processes were never complete.
    if (inventory_.discovery == Discovery::kMulticast) {
      throw ConfigError(
          entry->place + ": inventory.security",
          "keys together with multicast, with which some processes never authenticate",
          "discovery: peers");
    }
  }

  void read_rigs(const Entry& list) {
    const std::string want = "a list of rigs, each {name: left, number: 1}";
    const std::string kinds = "simulation or devices";
    const auto& items = items_of(list, "inventory.rigs", want);
    if (items.empty()) refuse(list, "inventory.rigs", want);
    std::vector<std::pair<const Entry*, const Entry*>> seen;  // name and number
    for (std::size_t i = 0; i < items.size(); ++i) {
      const std::string path = item_path("rigs", i);
      SectionReader reader(items[i], path);
      allow_only(reader, {"name", "number", "made_of"});
      const Entry& name = required(reader, items[i], path, "name", "name: the rig's name");
      const Entry& number =
          required(reader, items[i], path, "number", "number: the rig's key on the bus");
      std::int64_t value = 0;
      reader("number", value, Range{1, std::numeric_limits<std::uint32_t>::max()}, "key");
      const Entry* kind = reader.find("made_of");
      const bool devices = kind != nullptr && kind->text == "devices";
      if (kind != nullptr && !devices && kind->text != "simulation") {
        refuse(*kind, path + ".made_of", kinds);
      }
      inventory_.rigs.push_back(
          {name_in(name, path + ".name"), static_cast<std::uint32_t>(value), devices});
      for (std::size_t k = 0; k < i; ++k) {
        if (inventory_.rigs[k].name == inventory_.rigs[i].name) {
          refuse_second(name, path + ".name", *seen[k].first, "a different name for each rig");
        }
        if (inventory_.rigs[k].number == inventory_.rigs[i].number) {
          refuse_second(number, path + ".number", *seen[k].second,
                        "a different number for each rig");
        }
      }
      seen.emplace_back(&name, &number);
    }
  }

  void read_hosts(const Entry& list) {
    const std::string want = "a list of machines, each with name, address and services";
    const auto& items = items_of(list, "inventory.hosts", want);
    if (items.empty()) refuse(list, "inventory.hosts", want);
    for (std::size_t i = 0; i < items.size(); ++i) read_host(items[i], item_path("hosts", i));
  }

  void read_host(const Entry& item, const std::string& path) {
    SectionReader reader(item, path);
    allow_only(reader, {"name", "address", "start", "prefix", "services"});
    Host host;
    const Entry& name = required(reader, item, path, "name", "name: the machine's name");
    const Entry& address = required(reader, item, path, "address", "address: its IPv4 address");
    host.place = item.place;
    host.name = name_in(name, path + ".name");
    host.address = address_in(address, path + ".address");
    for (const SeenHost& seen : seen_) {
      if (seen.name.text == host.name) {
        refuse_second(name, path + ".name", seen.name, "a different name for each host");
      }
      if (seen.address.text == host.address) {
        refuse_second(address, path + ".address", seen.address,
                      "a different address for each host");
      }
    }
    seen_.push_back({path, name, address});
    refuse_loopback_beside_others();
    read_start(reader, item, path, host);
    read_prefix(reader, path, host);
    const Entry* services = reader.find("services");
    // A host without services only watches: its tools and the other hosts find each other.
    if (services != nullptr) placements_.read(*services, path + ".services", host);
    inventory_.hosts.push_back(std::move(host));
  }

  // Other hosts cannot reach a loopback address.
  void refuse_loopback_beside_others() const {
    if (seen_.size() < 2) return;
    for (const SeenHost& seen : seen_) {
      if (seen.address.text.starts_with("127.")) {
        refuse(seen.address, seen.path + ".address",
               "an address at which the others reach this host");
      }
    }
  }

  void read_start(SectionReader& reader, const Entry& item, const std::string& path, Host& host) {
    const Entry* start = reader.find("start");
    if (start == nullptr) {
      if (here_ != nullptr) {
        throw ConfigError(item.place + ": " + path,
                          "no \"start\", like the host at " + here_->place,
                          "start: [ssh, NAME] for every host but this machine");
      }
      here_ = &item;
      return;
    }
    const std::string want = "a list of words before a command, such as [ssh, rig-pc]";
    const auto& words = items_of(*start, path + ".start", want);
    if (words.empty()) refuse(*start, path + ".start", want);
    for (const Entry& word : words) host.start.push_back(text_of(word, path + ".start", want));
  }

  static void read_prefix(SectionReader& reader, const std::string& path, Host& host) {
    const Entry* prefix = reader.find("prefix");
    if (prefix == nullptr) {
      host.prefix = runtime::prefix();
      return;
    }
    // The prefix becomes part of systemd's command lines, where blanks, quotes, % and $ are
    // special.
    const std::string want =
        "the absolute path of bin/stillhand's prefix, such as /usr, of letters, digits and /._+-";
    host.prefix = text_of(*prefix, path + ".prefix", want);
    const auto plain = [](unsigned char c) {
      return std::isalnum(c) != 0 ||
             std::string_view("/._+-").find(static_cast<char>(c)) != std::string_view::npos;
    };
    if (!host.prefix.is_absolute() || !std::ranges::all_of(host.prefix.string(), plain)) {
      refuse(*prefix, path + ".prefix", want);
    }
  }

  Entry top_;
  Inventory inventory_;
  std::vector<SeenHost> seen_;
  const Entry* here_ = nullptr;  ///< the host without words before a command
  Placements placements_{inventory_.rigs};
};

}  // namespace

Inventory read_inventory(const std::filesystem::path& file) {
  return Reader(settings::parse_file(file), file).read();
}

Inventory parse_inventory(const std::string& yaml, const std::filesystem::path& file) {
  return Reader(settings::parse_text(yaml, file.string()), file).read();
}

}  // namespace stillhand::deploy
