// SPDX-License-Identifier: Apache-2.0
#include "apps/deploy/placements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "apps/deploy/inventory_values.hpp"
#include "apps/deploy/ports.hpp"
#include "idl/topics.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/settings/nearest.hpp"

namespace stillhand::deploy {
namespace {

using settings::Entry;

std::string service_in(const Entry& entry, const std::string& path) {
  std::string service = text_of(entry, path, "the name of a service");
  if (std::ranges::find(topics::kServices, service) == topics::kServices.end()) {
    refuse(entry, path, "a service: " + settings::suggestion(service, topics::kServices));
  }
  return service;
}

}  // namespace

void Placements::read(const Entry& list, const std::string& path, Host& host) {
  const auto& items = items_of(list, path, "a list of services, such as [rig, sensing]");
  if (items.size() > kMostServicesOnAHost) {
    throw ConfigError(list.place + ": " + path, fmt::format("{} services", items.size()),
                      fmt::format("at most {} on a host: more would use the next domain's ports",
                                  kMostServicesOnAHost));
  }
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string at = item_path(path, i);
    Placement placement = placement_in(items[i], at);
    const auto [place, fresh] = placed_.try_emplace({placement.service, placement.rig}, &items[i]);
    if (!fresh) {
      const auto rig = std::ranges::find(rigs_, placement.rig, &Rig::number);
      throw ConfigError(
          items[i].place + ": " + at,
          fmt::format("a second {} for rig {}", placement.service, rig->name),
          fmt::format("each service once for each rig; the first is at {}", place->second->place));
    }
    host.services.push_back(std::move(placement));
  }
}

Placement Placements::placement_in(const Entry& item, const std::string& path) const {
  const std::string form = fmt::format("{{service: rig, rig: {}}}", rigs_.front().name);
  if (item.kind != Entry::Kind::kMap) {
    if (rigs_.size() > 1) refuse(item, path, form + ", because there are several rigs");
    return {service_in(item, path), rigs_.front().number};
  }
  settings::SectionReader reader(item, path);
  allow_only(reader, {"service", "rig"});
  const Entry& service = required(reader, item, path, "service", form);
  const Entry& rig = required(reader, item, path, "rig", form);
  return {service_in(service, path + ".service"), rig_in(rig, path + ".rig")};
}

std::uint32_t Placements::rig_in(const Entry& entry, const std::string& path) const {
  const std::string name = text_of(entry, path, "the name of a rig");
  const auto found = std::ranges::find(rigs_, name, &Rig::name);
  if (found != rigs_.end()) return found->number;
  std::vector<std::string_view> names;
  for (const Rig& rig : rigs_) names.push_back(rig.name);
  refuse(entry, path, "a rig: " + settings::suggestion(name, names));
}

void Placements::refuse_absent(const Entry& hosts) const {
  for (const Rig& rig : rigs_) {
    for (const std::string_view service : topics::kServices) {
      if (placed_.contains({std::string(service), rig.number})) continue;
      throw ConfigError(hosts.place + ": inventory.hosts",
                        fmt::format("no host that runs {} for rig {}", service, rig.name),
                        "each service on exactly one host for each rig");
    }
  }
}

}  // namespace stillhand::deploy
