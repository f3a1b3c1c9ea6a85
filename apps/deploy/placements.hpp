// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "apps/deploy/inventory.hpp"
#include "services/files/settings/section.hpp"

namespace stillhand::deploy {

/// Reads the services of the hosts, one host after the other, and checks that each service runs
/// exactly once for each rig.
class Placements {
 public:
  /// @param rigs  rigs of the inventory, at least one; must outlive this object
  explicit Placements(const std::vector<Rig>& rigs) : rigs_(rigs) {}

  /// Adds the services of a list to the host.  The list must outlive this object.
  /// @throws ConfigError for an unknown service or rig, or a service that runs twice for a rig
  void read(const settings::Entry& list, const std::string& path, Host& host);
  /// @throws ConfigError naming a service that no host runs for a rig
  void refuse_absent(const settings::Entry& hosts) const;

 private:
  Placement placement_in(const settings::Entry& item, const std::string& path) const;
  std::uint32_t rig_in(const settings::Entry& entry, const std::string& path) const;

  const std::vector<Rig>& rigs_;
  std::map<std::pair<std::string, std::uint32_t>, const settings::Entry*> placed_;
};

}  // namespace stillhand::deploy
