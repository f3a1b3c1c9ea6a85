// SPDX-License-Identifier: Apache-2.0
#include "apps/deploy/inventory.hpp"

#include <algorithm>
#include <array>

#include "services/core/contract/expects.hpp"

namespace stillhand::deploy {

std::string_view name_of(Discovery discovery) {
  constexpr std::array kNames{"peers", "server", "multicast"};
  return kNames.at(static_cast<std::size_t>(discovery));
}

const Host* Inventory::find_host(std::string_view name) const {
  const auto found = std::ranges::find(hosts, name, &Host::name);
  return found == hosts.end() ? nullptr : &*found;
}

const Host& Inventory::host_of(std::string_view service, std::uint32_t rig) const {
  const auto found = std::ranges::find_if(hosts, [&](const Host& host) {
    return std::ranges::any_of(host.services, [&](const Placement& each) {
      return each.service == service && each.rig == rig;
    });
  });
  STILLHAND_EXPECTS(found != hosts.end());
  return *found;
}

const Rig& Inventory::rig(std::uint32_t number) const {
  const auto found = std::ranges::find(rigs, number, &Rig::number);
  STILLHAND_EXPECTS(found != rigs.end());
  return *found;
}

}  // namespace stillhand::deploy
